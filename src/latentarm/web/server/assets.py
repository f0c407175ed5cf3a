"""Scripts, style sheets and pictures of the pages: read and compressed once, and cached by browsers."""

import gzip
import hashlib
import posixpath
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from starlette.requests import Request
from starlette.responses import Response

from latentarm.core.errors import UserError

FOLDER: Final = Path(__file__).parent.parent / "pages"
THREE: Final = "three/three.module.min.js"  # path of three.js among the assets
_THREE: Final = FOLDER.parent / "three"  # filled when the package is built, see hatch_build.py

_TYPES: Final = {
    ".js": "text/javascript",
    ".css": "text/css",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webmanifest": "application/manifest+json",
}
_IMPORT: Final = re.compile(rb'^(?:import|export)\s[^"]*"(\.[^"]+\.js)"', re.MULTILINE)
_COMMENT: Final = re.compile(rb"^[ \t]*/\*\*(?:[^*]|\*(?!/))*\*/", re.MULTILINE)

_KEPT: Final = "private, max-age=31536000, immutable"


@final
@dataclass(frozen=True)
class _Asset:
    content: bytes
    compressed: bytes
    media_type: str


@final
class Assets:
    """Everything that a page loads besides its HTML.

    Each path holds a hash of all assets, so that browsers may cache them for ever.
    """

    def __init__(self) -> None:
        found = {
            path.relative_to(FOLDER).as_posix(): path
            for path in sorted(FOLDER.rglob("*"))
            if path.suffix in _TYPES
        }
        found |= {f"three/{path.name}": path for path in sorted(_THREE.glob("*.js"))}
        if THREE not in found:
            raise UserError("three.js is missing: install latentarm again, which fetches it from npm.")
        self._assets = {name: _read(path) for name, path in found.items()}
        digest = hashlib.sha256()
        for name, asset in self._assets.items():
            digest.update(f"{name} {len(asset.content)}\n".encode() + asset.content)
        self._version = digest.hexdigest()[:16]

    def path(self, name: str) -> str:
        """An asset's URL by its path among the pages. Raises KeyError if there is no such asset."""
        if name not in self._assets:
            raise KeyError(name)
        return f"/static/{self._version}/{name}"

    def modules(self, script: str) -> list[str]:
        """A script and everything that it imports, directly or not, but nothing that it loads later."""
        found = [script]
        for module in found:
            folder = posixpath.dirname(module)
            for named in _IMPORT.findall(self._assets[module].content):
                path = posixpath.normpath(posixpath.join(folder, named.decode()))
                if path not in found:
                    found.append(path)
        return found

    async def answer(self, request: Request) -> Response:
        """Serve ``/static/{version}/{name}``."""
        asset = self._assets.get(request.path_params["name"])
        if asset is None or request.path_params["version"] != self._version:
            return Response(status_code=404)
        headers = {"cache-control": _KEPT, "etag": f'"{self._version}"', "vary": "accept-encoding"}
        if request.headers.get("if-none-match") == headers["etag"]:
            return Response(status_code=304, headers=headers)
        content = asset.content
        if "gzip" in request.headers.get("accept-encoding", ""):
            content = asset.compressed
            headers["content-encoding"] = "gzip"
        return Response(content, headers=headers, media_type=asset.media_type)


def _read(path: Path) -> _Asset:
    content = path.read_bytes()
    if path.suffix == ".js" and FOLDER in path.parents:
        # Types and explanations are a quarter of what is sent. Lines keep their numbers.
        content = _COMMENT.sub(lambda found: b"\n" * found[0].count(b"\n"), content)
    return _Asset(content, gzip.compress(content, mtime=0), _TYPES[path.suffix])
