"""Recordings of this and of earlier server starts: journals in the output folder."""

import re
import sqlite3
import threading
import time
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal, final

from pydantic import Field

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import is_missing
from latentarm.core.untrusted.terminal import one_line
from latentarm.recordings.folder import JOURNAL_SUFFIX
from latentarm.recordings.journal_reader import list_journal
from latentarm.web.protocol.notice import Message, Notice, NoticeError
from latentarm.web.records.drives import UNDO_S
from latentarm.web.records.record_files import disk_errors, read_record, write_record

_TITLES: Final = "recordings.json"
_HIDDEN: Final = ".deleted-"
_BESIDE: Final = ("", "-wal", "-shm", "-journal")
_MOST: Final = 2000

FileName = Annotated[str, Field(max_length=255)]
Title = Annotated[str, Field(max_length=80)]


class RecordedEpisode(Message):
    """An episode of a recording: task, length in s, driver, start, and whether it is complete."""

    number: int
    task: str
    seconds: float
    person: str
    started: str  # ISO 8601 in UTC; "" where unknown
    complete: bool


class RecordingFile(Message):
    """A recording."""

    name: str  # of its file
    title: str  # given by people; "" for none
    bytes: int
    episodes: tuple[RecordedEpisode, ...]
    in_use: bool  # whether it may still be written to, and so not be deleted
    problem: Notice | None  # why it cannot be read; None if it can


class _Titles(Message):
    version: Literal[1] = 1
    titles: Annotated[dict[FileName, Title], Field(max_length=_MOST)] = Field(default_factory=dict)


@final
@dataclass(eq=False)
class Recordings:
    """Journals by file name.

    All methods wait for the disk, and raise `UserError` if there is no such recording, or files cannot be
    read, written, moved or deleted.
    """

    _out: Path  # folder of the journals
    _folder: Path  # that of the titles
    _in_use: Callable[[], Path | None]  # path of the journal that is being written

    def __post_init__(self) -> None:
        self._titles_path = self._folder / _TITLES
        self._lock = threading.Lock()
        self._deleted: dict[str, float] = {}
        self._listed: dict[str, tuple[tuple[int, int], tuple[RecordedEpisode, ...]]] = {}
        for path in self._out.glob(f"{_HIDDEN}*"):
            with suppress(OSError):
                path.unlink()

    def all(self) -> list[RecordingFile]:
        """Every recording, the newest first."""
        with self._lock:
            titles = self._titles()
            return [self._look(path, titles.get(path.name, "")) for path in reversed(self._journals())]

    def entitle(self, name: str, title: str) -> None:
        with self._lock:
            self._path(name)
            known = {path.name for path in self._journals()}
            titles = {key: text for key, text in self._titles().items() if key in known}
            write_record(_Titles(titles={**titles, name: title}), self._titles_path)

    def delete(self, name: str) -> None:
        """Delete a recording that is not in use; `restore` brings it back for a while."""
        with self._lock:
            path = self._path(name)
            if self._used(path):
                raise NoticeError("recording_in_use")
            _move(path, path.with_name(_HIDDEN + name))
            self._deleted[name] = time.monotonic() + UNDO_S

    def restore(self, name: str) -> None:
        with self._lock:
            if name not in self._deleted:
                raise NoticeError("record_unknown")
            _move(self._out / (_HIDDEN + name), self._out / name)
            del self._deleted[name]

    def purge(self) -> None:
        """Remove recordings that can no longer be restored."""
        with self._lock:
            for name in [name for name, until_s in self._deleted.items() if until_s <= time.monotonic()]:
                _unlink(self._out / (_HIDDEN + name))
                del self._deleted[name]

    def of_person(self, person: str) -> list[tuple[str, RecordedEpisode]]:
        """Episodes of a person, each with the name of its file."""
        with self._lock:
            looked = [self._look(path, "") for path in self._journals()]
        return [(file.name, one) for file in looked for one in file.episodes if one.person == person]

    def forget(self, person: str, name: str) -> None:
        """Delete every episode of a person, also in deleted recordings, and titles that contain the name."""
        with self._lock:
            for hidden in list(self._deleted):
                looked = self._look(self._out / (_HIDDEN + hidden), "")
                if looked.problem is not None or any(one.person == person for one in looked.episodes):
                    _unlink(self._out / (_HIDDEN + hidden))
                    del self._deleted[hidden]
            for path in self._journals():
                looked = self._look(path, "")
                if any(one.person == person for one in looked.episodes):
                    only = all(one.person == person for one in looked.episodes)
                    if only and not looked.in_use:
                        _unlink(path)
                    else:
                        _erase(path, person)
            titles = self._titles()
            left = {key: text for key, text in titles.items() if not _names(text, name)}
            if left != titles:
                write_record(_Titles(titles=left), self._titles_path)

    def _journals(self) -> list[Path]:
        found = [path for path in self._out.glob(f"*{JOURNAL_SUFFIX}") if not path.name.startswith(".")]
        return sorted(found)[-_MOST:]

    def _path(self, name: str) -> Path:
        """The path of an existing journal, by a name from a page."""
        for path in self._journals():
            if path.name == name:
                return path
        raise NoticeError("record_unknown")

    def _used(self, path: Path) -> bool:
        used = self._in_use()
        return used is not None and used.resolve() == path.resolve()

    def _look(self, path: Path, title: str) -> RecordingFile:
        episodes: tuple[RecordedEpisode, ...] = ()
        problem: Notice | None = None
        size = 0
        try:
            size, state = _state(path)
            known = self._listed.get(path.name)
            if known is not None and known[0] == state:
                episodes = known[1]
            else:
                episodes = tuple(
                    RecordedEpisode(
                        number=entry.number,
                        task=entry.header.task,
                        seconds=round(entry.duration_s, 1),
                        person=entry.header.provenance.person,
                        started=entry.header.provenance.started_utc,
                        complete=entry.complete,
                    )
                    for entry in list_journal(path)
                )
                self._listed[path.name] = (state, episodes)
        except (UserError, OSError) as error:
            problem = Notice(code="recording_unreadable", parameters={"text": one_line(str(error))})
        return RecordingFile(
            name=path.name,
            title=title,
            bytes=size,
            episodes=episodes,
            in_use=self._used(path),
            problem=problem,
        )

    def _titles(self) -> dict[str, str]:
        return {} if is_missing(self._titles_path) else read_record(_Titles, self._titles_path).titles


def _names(text: str, name: str) -> bool:
    """Whether a text contains a person's name: as a whole word in scripts that divide words."""
    text, name = text.casefold(), name.casefold()
    if not name.isascii():
        return name in text
    return re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text) is not None


def _state(path: Path) -> tuple[int, tuple[int, int]]:
    """Size of a journal with its log, bytes, and a value that changes with every write."""
    files = [path.with_name(path.name + end) for end in _BESIDE[:2]]
    found = [file.stat() for file in files if not is_missing(file)]
    size = sum(one.st_size for one in found)
    return size, (size, max(one.st_mtime_ns for one in found))


def _move(start: Path, end: Path) -> None:
    """Move a journal after its log: a journal without its log would seem complete."""
    with disk_errors(start, "moved"):
        for beside in reversed(_BESIDE):
            with suppress(FileNotFoundError):
                start.with_name(start.name + beside).replace(end.with_name(end.name + beside))


def _unlink(path: Path) -> None:
    with disk_errors(path, "deleted"):
        for beside in _BESIDE:
            path.with_name(path.name + beside).unlink(missing_ok=True)


def _erase(path: Path, person: str) -> None:
    """Remove a person's episodes from a journal, so that none of their bytes stays in the file."""
    mine = "SELECT id FROM episodes WHERE json_extract(about, '$.provenance.person') = ?"
    try:
        with closing(sqlite3.connect(path, isolation_level=None, timeout=5.0)) as database:
            database.execute("PRAGMA trusted_schema = OFF")
            database.execute("PRAGMA secure_delete = ON")
            database.execute("BEGIN IMMEDIATE")
            database.execute(f"DELETE FROM samples WHERE episode IN ({mine})", (person,))  # noqa: S608
            database.execute(f"DELETE FROM episodes WHERE id IN ({mine})", (person,))  # noqa: S608
            database.execute("COMMIT")
            database.execute("VACUUM")
            database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    except sqlite3.Error as error:
        raise UserError(f"{path} cannot be changed ({error}): end the recording first.") from error
