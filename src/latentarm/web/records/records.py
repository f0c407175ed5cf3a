"""A person's records: counting, exporting, importing and deleting them."""

import json
import shutil
import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final, final

from latentarm.alignment.profile import load_profile, profile_folder
from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.folders import staged_folder
from latentarm.models.saving import WEIGHTS_LIMIT
from latentarm.web.records import person_zip
from latentarm.web.records.drive_log import Logged
from latentarm.web.records.drives import TRACE, Drives, Wanted
from latentarm.web.records.people import PERSON_NAME, KeptProfile, People, PersonRecord
from latentarm.web.records.poses import POSES_NAME, PosesRecord, read_poses, write_poses
from latentarm.web.records.record_files import disk_errors, new_id
from latentarm.web.records.recordings import Recordings
from latentarm.web.records.scenes import Scenes

FOLDER: Final = "records"  # name of the records' folder in the output folder


@final
class Records:
    """Everything that the server keeps of people.

    Methods wait for the disk, and raise `UserError` if there is no such person, or files cannot be read,
    written or deleted. ``runs`` returns folders of runs by name, ``in_use`` the path of the journal that is
    being written.
    """

    def __init__(
        self, out: Path, runs: Callable[[], Mapping[str, Path]], in_use: Callable[[], Path | None]
    ) -> None:
        folder = out / FOLDER
        self.people = People(folder / "people")
        self.drives = Drives(folder, folder / "people")
        self.scenes = Scenes(folder / "scenes")
        self.recordings = Recordings(out, folder, in_use)
        self._folder = folder
        self._scenes_lock = threading.Lock()
        self._runs = runs

    def keep(self, logged: Logged) -> None:
        """Keep a drive that has ended, with its scene."""
        with self._scenes_lock:
            scene = self.scenes.keep(logged.scene)
            self.drives.keep(logged.record.model_copy(update={"scene": scene}), logged.trace())

    def contents(self, person: str) -> dict[str, int]:
        return {
            "drives": len(self.drives.wanted(Wanted(person=person))),
            "profiles": len(self._profiles(self.people.known(person))),
            "episodes": len(self.recordings.of_person(person)),
        }

    def export(self, person: str) -> Path:
        """Write all of a person's records to a temporary zip file, for the caller to delete."""
        known = self.people.known(person)
        path = self._folder / f".export-{new_id()}.zip"
        try:
            person_zip.write_zip(path, self._everything(known))
        except UserError:
            path.unlink(missing_ok=True)
            raise
        return path

    def bring(self, content: bytes) -> dict[str, str | int]:
        """Import a person from an `export`, under a new id.

        Returns their id and name, numbers of their records, and of profiles that fit no run here.
        """
        brought = person_zip.read_zip(content)
        profiles = brought.person.profiles

        def write(folder: Path, person: str) -> None:
            person_zip.write_drives(brought.drives, folder, person)
            if brought.poses:
                write_poses(folder, brought.poses)

        with self._scenes_lock:
            for place, scene in brought.scenes.items():
                self.scenes.take(place, scene)
            person = self.people.adopt(brought.person.model_copy(update={"profiles": ()}), write)
            self.drives.adopt(person.id)
        taken = [
            self._take_profile(person.id, profile, files)
            for profile, files in zip(profiles, brought.profiles, strict=True)
        ]
        kept = {"drives": len(brought.drives), "profiles": sum(taken), "left_out": len(taken) - sum(taken)}
        return {"person": person.id, "name": person.name, **kept}

    def erase(self, person: str) -> None:
        """Delete everything of a person, the person last, so that a failure can be repeated."""
        known = self.people.known(person)
        for folder in self._profiles(known).values():
            with disk_errors(folder, "deleted"):
                shutil.rmtree(folder)
        self.recordings.forget(person, known.name)
        self.people.remove(person)
        self.drives.forget(person)
        self._tidy_scenes()

    def purge(self) -> None:
        """Remove what can no longer be restored."""
        self.drives.purge()
        self.recordings.purge()
        self._tidy_scenes()

    def _tidy_scenes(self) -> None:
        """Delete scenes without drives; none while there are drives that cannot be read."""
        with self._scenes_lock:
            if not self.drives.problems:
                self.scenes.keep_only(self.drives.scenes)

    def _profiles(self, person: PersonRecord) -> dict[KeptProfile, Path]:
        runs = self._runs()
        found = {one: profile_folder(runs[one.run], one.name) for one in person.profiles if one.run in runs}
        return {one: folder for one, folder in found.items() if folder.is_dir()}

    def _everything(self, person: PersonRecord) -> Iterator[tuple[str, bytes]]:
        profiles = self._profiles(person)
        kept = person.model_copy(update={"profiles": tuple(profiles), "pin": None})
        yield PERSON_NAME, kept.model_dump_json(indent=1).encode()
        poses = read_poses(self.people.folder_of(person.id))
        if poses:
            yield POSES_NAME, PosesRecord(poses=poses).model_dump_json(indent=1).encode()
        scenes: set[str] = set()
        for drive in self.drives.wanted(Wanted(person=person.id)):
            place = f"drives/{drive.id}.json"
            yield place, drive.model_dump_json(indent=1).encode()
            trace = self.drives.packed(drive.id)
            if trace is not None:
                yield place.removesuffix(".json") + TRACE, trace
            scenes |= {drive.scene} if drive.scene else set()
        places = {
            name: content for scene in sorted(scenes) for name, content in self.scenes.files(scene).items()
        }
        for name, content in places.items():
            yield f"{person_zip.SCENES}{name}", content
        for index, folder in enumerate(profiles.values()):
            for file in sorted(folder.iterdir()):
                yield f"{person_zip.PROFILES}{index}/{file.name}", read_bytes(file, WEIGHTS_LIMIT)
        episodes = [{"file": name, **one.model_dump()} for name, one in self.recordings.of_person(person.id)]
        yield "recordings.json", json.dumps(episodes, indent=1).encode()

    def _take_profile(self, person: str, profile: KeptProfile, files: Mapping[str, bytes]) -> bool:
        """Keep an imported profile; returns whether it fits a run that is here."""
        run = self._runs().get(profile.run)
        if run is None or not files:
            return False
        try:
            folder = profile_folder(run, profile.name)
            with staged_folder(folder) as staging:
                for name, content in files.items():
                    (staging / name).write_bytes(content)
        except UserError:  # there is one of this name
            return False
        try:
            load_profile(run, profile.name)
        except UserError:  # of another model, or damaged
            shutil.rmtree(folder)
            return False
        self.people.add_profile(person, profile.run, profile.name)
        return True
