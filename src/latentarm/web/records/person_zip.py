"""All of a person's records as one zip file, and back.

An imported file is a stranger's: what is damaged, encrypted or too large raises `NoticeError`.
"""

import io
import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.web.protocol.notice import NoticeError
from latentarm.web.records.drive_record import PACKED_LIMIT, DriveRecord, checked_trace
from latentarm.web.records.drives import DRIVES, TRACE
from latentarm.web.records.people import PERSON_NAME, PersonRecord
from latentarm.web.records.poses import POSES_NAME, PosesRecord, SavedPose
from latentarm.web.records.record_files import (
    DOCUMENT_LIMIT,
    ID,
    disk_errors,
    new_id,
    parse_record,
    write_record,
)

IMPORT_LIMIT: Final = 1 << 26  # the largest file that is imported, bytes
SCENES: Final = "scenes/"
PROFILES: Final = "profiles/"

_UNPACKED_LIMIT: Final = 1 << 28
_MOST_FILES: Final = 20_000
_DRIVE: Final = re.compile(rf"{DRIVES}/({ID.pattern})\.json")
_SCENE: Final = re.compile(rf"{SCENES}([0-9a-f]{{32}}\.json|meshes/[0-9a-f]{{64}})")
_PROFILE: Final = re.compile(rf"{PROFILES}\d{{1,4}}/(config\.json|alignment\.safetensors)")
# RuntimeError is an encrypted file.
_DAMAGE: Final = (zipfile.BadZipFile, zlib.error, OSError, EOFError, ValueError, KeyError, RuntimeError)
_FIRST_DATE: Final = (1980, 1, 1, 0, 0, 0)


@final
@dataclass(frozen=True)
class Brought:
    """A person from a zip, with all that this version knows of them."""

    person: PersonRecord
    poses: tuple[SavedPose, ...]  # older zips have none
    drives: list[tuple[DriveRecord, bytes | None]]  # each with its compressed trace
    scenes: dict[str, bytes]  # by their places among the scenes
    profiles: list[dict[str, bytes]]  # the files of each of the person's profiles, by name


def write_zip(path: Path, contents: Iterator[tuple[str, bytes]]) -> None:
    """Write a zip from names and contents. Raises UserError if it cannot be written."""
    with disk_errors(path, "written"), zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents:
            archive.writestr(zipfile.ZipInfo(name, _FIRST_DATE), content, zipfile.ZIP_DEFLATED)


def read_zip(content: bytes) -> Brought:
    """Read and check a zip. Raises NoticeError if it is damaged, encrypted, too large, or no export."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            if len(entries) > _MOST_FILES or sum(one.file_size for one in entries) > _UNPACKED_LIMIT:
                raise NoticeError("import_invalid")
            files = {one.filename: _read(archive, one) for one in entries if _limit(one.filename)}
        person = parse_record(PersonRecord, files[PERSON_NAME], PERSON_NAME)
        poses = parse_record(PosesRecord, files[POSES_NAME], POSES_NAME).poses if POSES_NAME in files else ()
        drives = [_drive(files, name) for name in files if _DRIVE.fullmatch(name)]
    except (*_DAMAGE, UserError) as error:
        raise NoticeError("import_invalid") from error
    profiles = [_within(files, f"{PROFILES}{index}/") for index, _ in enumerate(person.profiles)]
    return Brought(person, poses, drives, _within(files, SCENES), profiles)


def write_drives(drives: list[tuple[DriveRecord, bytes | None]], folder: Path, person: str) -> None:
    """Write drives into a new person's folder, under new ids. Raises UserError if they cannot be written."""
    for drive, trace in drives:
        path = folder / DRIVES / f"{new_id()}.json"
        if trace is not None:
            with written_whole(path.with_suffix(TRACE)) as part:
                part.write_bytes(trace)
        write_record(drive.model_copy(update={"id": path.stem, "person": person}), path)


def _drive(files: Mapping[str, bytes], name: str) -> tuple[DriveRecord, bytes | None]:
    trace = files.get(name.removesuffix(".json") + TRACE)
    if trace is not None:
        checked_trace(trace, name)
    return parse_record(DriveRecord, files[name], name), trace


def _within(files: Mapping[str, bytes], folder: str) -> dict[str, bytes]:
    """The files in a folder, by their places in it."""
    return {name.removeprefix(folder): content for name, content in files.items() if name.startswith(folder)}


def _limit(name: str) -> int:
    """The largest size of a file, bytes; 0 for an unknown file, which is skipped."""
    if name in (PERSON_NAME, POSES_NAME) or _DRIVE.fullmatch(name):
        return DOCUMENT_LIMIT
    trace = name.endswith(TRACE) and _DRIVE.fullmatch(name.removesuffix(TRACE) + ".json")
    return PACKED_LIMIT if trace or _SCENE.fullmatch(name) or _PROFILE.fullmatch(name) else 0


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """The content of an entry, whose declared size may be a lie."""
    limit = _limit(entry.filename)
    with archive.open(entry) as stream:
        content = stream.read(limit + 1)
    if len(content) > limit:
        raise NoticeError("import_invalid")
    return content
