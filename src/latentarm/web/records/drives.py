"""All drives on disk: a record and a trace each, in the driver's folder."""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.untrusted.opening import is_missing, read_bytes
from latentarm.web.protocol.notice import Notice, NoticeError
from latentarm.web.records.drive_record import PACKED_LIMIT, DriveRecord, Trace, checked_trace, packed
from latentarm.web.records.record_files import disk_errors, read_record, unreadable, write_record

UNDO_S: Final = 600.0  # how long a deletion can be undone, s
DRIVES: Final = "drives"

TRACE: Final = ".trace.gz"  # suffix of a trace, in place of ``.json``
_TRASH: Final = "deleted"


@final
@dataclass(frozen=True)
class Wanted:
    """A query for drives; None for any."""

    person: str | None = None  # id; "" for guests
    task: str | None = None  # name
    input: str | None = None  # a kind of device that was used
    since: str | None = None  # first day, ``YYYY-MM-DD`` in UTC
    until: str | None = None  # last day, as above

    def takes(self, drive: DriveRecord) -> bool:
        return (
            self.person in (None, drive.person or "")
            and self.task in (None, drive.task)
            and (self.input is None or self.input in drive.inputs)
            and (self.since is None or self.since <= drive.started[:10])
            and (self.until is None or drive.started[:10] <= self.until)
        )


@final
class Drives:
    """All drives. Deleted ones can be restored for `UNDO_S`, until the server is started again.

    Methods other than `wanted` and `find` wait for the disk, and raise `UserError` if there is no such drive,
    or files cannot be read, written, moved or deleted. The folders need not exist yet.
    """

    def __init__(self, folder: Path, people: Path, now_s: Callable[[], float] = time.monotonic) -> None:
        self._people = people
        self._guests = folder / "guests" / DRIVES
        self._trash = folder / _TRASH
        self._now_s = now_s
        self._lock = threading.Lock()
        self._drives: dict[str, DriveRecord] = {}
        self._deleted: dict[str, tuple[float, DriveRecord]] = {}
        self.problems: list[Notice] = []  # of records that cannot be read, one each
        for path in self._trash.glob("*"):
            with suppress(OSError):
                path.unlink()
        for path in sorted([*people.glob(f"*/{DRIVES}/*.json"), *self._guests.glob("*.json")]):
            try:
                self._take(path)
            except UserError as error:
                self.problems.append(unreadable(error))

    def wanted(self, wanted: Wanted) -> list[DriveRecord]:
        """Drives, the newest first."""
        found = [drive for drive in list(self._drives.values()) if wanted.takes(drive)]
        return sorted(found, key=lambda drive: (drive.started, drive.id), reverse=True)

    def find(self, drive: str) -> DriveRecord | None:
        return self._drives.get(drive)

    def keep(self, drive: DriveRecord, trace: Trace) -> None:
        """Keep a new drive, the trace first."""
        with self._lock:
            path = self._path(drive)
            with written_whole(path.with_suffix(TRACE)) as part:
                part.write_bytes(packed(trace))
            write_record(drive, path)
            self._drives[drive.id] = drive

    def keep_so_far(self, drive: DriveRecord) -> None:
        """Write the drive under way, in case nothing more is written."""
        with self._lock:
            if drive.id not in self._drives.keys() | self._deleted.keys():
                write_record(drive, self._path(drive))

    @property
    def scenes(self) -> set[str]:
        """Ids of the scenes of all drives, deleted ones included."""
        with self._lock:
            known = [*self._drives.values(), *(record for _, record in self._deleted.values())]
        return {drive.scene for drive in known if drive.scene is not None}

    def trace(self, drive: str) -> bytes:
        """A drive's trace, compressed with gzip, after a check."""
        path = self._path(self._known(drive)).with_suffix(TRACE)
        content = read_bytes(path, PACKED_LIMIT)
        checked_trace(content, str(path))
        return content

    def entitle(self, drive: str, title: str) -> DriveRecord:
        with self._lock:
            changed = self._known(drive).model_copy(update={"title": title})
            write_record(changed, self._path(changed))
            self._drives[drive] = changed
            return changed

    def delete(self, drive: str) -> None:
        """Delete a drive; `restore` brings it back for a while."""
        with self._lock:
            record = self._known(drive)
            self._move(self._path(record), self._trash / f"{drive}.json")
            del self._drives[drive]
            self._deleted[drive] = (self._now_s() + UNDO_S, record)

    def restore(self, drive: str) -> DriveRecord:
        with self._lock:
            if drive not in self._deleted:
                raise NoticeError("record_unknown")
            _, record = self._deleted[drive]
            self._move(self._trash / f"{drive}.json", self._path(record))
            del self._deleted[drive]
            self._drives[drive] = record
            return record

    def purge(self) -> None:
        """Remove drives that can no longer be restored."""
        with self._lock:
            now_s = self._now_s()
            self._purge([drive for drive, (until_s, _) in self._deleted.items() if until_s <= now_s])

    def adopt(self, person: str) -> None:
        """Read the drives of a person whose folder was imported."""
        with self._lock:
            for path in sorted((self._people / person / DRIVES).glob("*.json")):
                self._take(path)

    def packed(self, drive: str) -> bytes | None:
        """A drive's compressed trace, unchecked; None if it has no trace."""
        path = self._path(self._known(drive)).with_suffix(TRACE)
        return None if is_missing(path) else read_bytes(path, PACKED_LIMIT)

    def forget(self, person: str) -> None:
        """Drop a person's drives; their folder is deleted elsewhere, their deleted drives here."""
        with self._lock:
            self._purge([drive for drive, (_, record) in self._deleted.items() if record.person == person])
            self._drives = {key: drive for key, drive in self._drives.items() if drive.person != person}

    def _take(self, path: Path) -> None:
        drive = read_record(DriveRecord, path)
        if path != self._path(drive) or drive.id in self._drives:
            raise UserError(f"{path} is the record of another drive or person than its place says.")
        self._drives[drive.id] = drive

    def _path(self, drive: DriveRecord) -> Path:
        folder = self._guests if drive.person is None else self._people / drive.person / DRIVES
        return folder / f"{drive.id}.json"

    def _known(self, drive: str) -> DriveRecord:
        found = self._drives.get(drive)
        if found is None:
            raise NoticeError("record_unknown")
        return found

    def _move(self, start: Path, end: Path) -> None:
        """Move a record with its trace, the record last, so that there is never a record alone."""
        with disk_errors(start, "moved"):
            end.parent.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):
                start.with_suffix(TRACE).replace(end.with_suffix(TRACE))
            start.replace(end)

    def _purge(self, drives: list[str]) -> None:
        for drive in drives:
            path = self._trash / f"{drive}.json"
            with disk_errors(path, "deleted"):
                for one in (path, path.with_suffix(TRACE)):
                    one.unlink(missing_ok=True)
            del self._deleted[drive]
