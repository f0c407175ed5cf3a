"""The scenes of earlier drives, so that they can be replayed whatever is driven now."""

import hashlib
import json
import re
import threading
from collections.abc import Container
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.untrusted.opening import is_missing, read_bytes
from latentarm.models.reading import Section
from latentarm.web.protocol.notice import NoticeError
from latentarm.web.protocol.scene import Drawable
from latentarm.web.records.record_files import disk_errors

_SCENE_LIMIT: Final = 1 << 22
_MESH_LIMIT: Final = 1 << 26
_MESHES: Final = "meshes"
_ID: Final = re.compile(r"[0-9a-f]{32}")
_DIGEST: Final = re.compile(r"[0-9a-f]{64}")


@final
class Scenes:
    """Scenes by a digest of their content; each mesh is kept once.

    Methods wait for the disk, and raise `UserError` if there is no such scene or mesh, or files are damaged
    or cannot be written or deleted.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.Lock()

    def keep(self, scene: Drawable) -> str:
        meshes = {
            str(number): hashlib.sha256(content).hexdigest() for number, content in scene.meshes.items()
        }
        document = json.dumps({"scene": scene.description, "meshes": meshes}, sort_keys=True).encode()
        key = hashlib.sha256(document).hexdigest()[:32]
        with self._lock:
            for number, digest in meshes.items():
                self._write(self._folder / _MESHES / digest, scene.meshes[int(number)])
            self._write(self._folder / f"{key}.json", document)
        return key

    def files(self, key: str) -> dict[str, bytes]:
        """A scene's files by their places in the folder: the scene, then its meshes."""
        digests = map(str, self._read(key).section("meshes").values.values())
        places = [f"{key}.json", *(f"{_MESHES}/{one}" for one in digests if _DIGEST.fullmatch(one))]
        return {place: read_bytes(self._folder / place, _MESH_LIMIT) for place in dict.fromkeys(places)}

    def take(self, place: str, content: bytes) -> None:
        """Keep an imported file if its content has the digest of its place."""
        digest = hashlib.sha256(content).hexdigest()
        if place in (f"{digest[:32]}.json", f"{_MESHES}/{digest}"):
            with self._lock:
                self._write(self._folder / place, content)

    def keep_only(self, keys: Container[str]) -> None:
        """Delete every scene with another id, and meshes without a readable scene."""
        with self._lock:
            found = sorted(self._folder.glob("*.json"))
            gone = [path for path in found if path.stem not in keys]
            meshes = {digest for path in found if path.stem in keys for digest in self._digests(path.stem)}
            gone += [path for path in self._folder.glob(f"{_MESHES}/*") if path.name not in meshes]
            for path in gone:
                with disk_errors(path, "deleted"):
                    path.unlink(missing_ok=True)

    def description(self, key: str) -> bytes:
        """A scene in the form of ``/scene.json``."""
        return json.dumps(self._read(key).values["scene"]).encode()

    def mesh(self, key: str, number: str) -> bytes:
        """A mesh in the form of ``/mesh/ID``."""
        digest = self._read(key).section("meshes").values.get(number)
        if not isinstance(digest, str) or not _DIGEST.fullmatch(digest):
            raise NoticeError("record_unknown")
        return read_bytes(self._folder / _MESHES / digest, _MESH_LIMIT)

    def _digests(self, key: str) -> list[str]:
        """Digests of a scene's meshes; none if it cannot be read."""
        try:
            return [str(digest) for digest in self._read(key).section("meshes").values.values()]
        except UserError:
            return []

    def _read(self, key: str) -> Section:
        if not _ID.fullmatch(key):
            raise NoticeError("record_unknown")
        scene = Section.of_file(self._folder / f"{key}.json", _SCENE_LIMIT)
        scene.section("scene")
        return scene

    def _write(self, path: Path, content: bytes) -> None:
        if not is_missing(path):
            return
        with written_whole(path) as part:
            part.write_bytes(content)
