"""The live journal of a drive: SQLite, readable after a kill at any moment."""

import json
import sqlite3
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.journal_limits import JournalFullError, JournalLimits, JournalWatch
from latentarm.core.types import NO_THINGS, Goal, Provenance, StatedLimits, StepRecord, StrPath
from latentarm.core.untrusted.opening import check_file, is_missing
from latentarm.demonstrations.info import goals_document
from latentarm.demonstrations.provenance import provenance_json
from latentarm.recordings.journal_samples import ALWAYS, figures_of, packed, without_things
from latentarm.robots.kinematics.pose_rows import STORED
from latentarm.robots.limits import LIMIT_NAMES, JointLimits
from latentarm.robots.limits_file import limits_document

SCHEMA_VERSION = 6
"""Version 2 made samples compact, version 3 gave them a gripper, version 4 things, version 5 a co-pilot's
pace, version 6 the source and the age of a thing's pose. All older versions can still be read and appended
to."""

_READABLE = (1, 2, 3, 4, 5, 6)
_PAGE_BYTES = 2048
"""Each sample is a transaction, and each transaction writes one or two whole pages to the log."""

_LOG_PAGES = 2000
"""Once the log reaches this length (4 MB), a commit checkpoints it into the file and the log restarts."""

_SCHEMA = """
CREATE TABLE episodes (
    id INTEGER PRIMARY KEY,
    about TEXT NOT NULL,
    complete INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE samples (
    episode INTEGER NOT NULL REFERENCES episodes (id),
    number INTEGER NOT NULL,
    figures BLOB NOT NULL,
    stop TEXT,
    limited_by TEXT NOT NULL,
    PRIMARY KEY (episode, number)
) WITHOUT ROWID;
"""

_COLUMNS = {
    "episodes": ("id", "about", "complete"),
    "samples": ("episode", "number", "figures", "stop", "limited_by"),
}


@final
@dataclass(frozen=True)
class EpisodeHeader:
    """The data that all samples of an episode share."""

    robot: str  # name or model path
    joint_names: tuple[str, ...]
    rate_hz: float  # nominal rate of the loop
    task: str = ""  # in words
    goals: tuple[Goal, ...] = ()
    modes: tuple[str, ...] = ("",)
    provenance: Provenance = field(default_factory=Provenance)
    end_effector: str | None = None  # site, body or link of the robot's model file
    limits: StatedLimits | None = None  # stated by a person
    joint_limits: JointLimits | None = None  # samples outside them are impossible; None if unknown
    things: tuple[str, ...] = ()  # names of the K things whose poses every sample has
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])  # speeds and limits, as JSON
    objects: tuple[str, ...] = ()
    """Those that matter for the task, in the order of the feature ``objects``; all where empty."""
    sources: tuple[str, ...] = ()  # that may say where things are; empty where no sample says which did


@final
class Recorder:
    """Writes every step of a drive to a journal, one small transaction each.

    `record` returns when its sample is acknowledged: committed to the write-ahead log, and so in the
    operating system's hands. A killed process loses none of them. Against a power cut the file stays
    readable and whole episodes are safe: `end_episode` flushes everything to the disk before it marks the
    episode complete. Samples of the episode under way may then be lost from its end.

    A commit costs tens of microseconds. Every thousand samples or so, one folds the log into the file and
    waits for the disk, which takes tens of milliseconds: a loop in real time records in another thread, as
    the page's does.

    About once a second the recorder checks that the journal still exists and has room.

    Args:
        path: the journal, a new file or one that `Recorder` wrote.
        limits: how much room the journal may take.

    Raises UserError where the file cannot be written, or is no journal.
    """

    def __init__(self, path: StrPath, limits: JournalLimits | None = None) -> None:
        path = Path(path)
        self._path = path
        self._watch = JournalWatch(path, limits or JournalLimits())
        self._samples_per_check = 100
        self._episode: int | None = None
        self._number = 0
        self._widths: tuple[int, ...] = ()
        self._things_width = self._sightings_width = 0
        self._things = NO_THINGS
        if not is_missing(path):
            check_file(path, sys.maxsize)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._database = sqlite3.connect(path, isolation_level=None, timeout=1.0, check_same_thread=False)
        except (OSError, sqlite3.Error) as error:
            raise _unwritable(path, error) from error
        try:
            self._open()
        except sqlite3.Error as error:
            self._database.close()
            raise _unwritable(path, error) from error
        except UserError:
            self._database.close()
            raise

    def _open(self) -> None:
        check_is_journal(self._database, self._path, may_be_empty=True)
        self._database.execute(f"PRAGMA page_size = {_PAGE_BYTES}")
        self._database.execute("PRAGMA journal_mode = WAL")
        self._database.execute("PRAGMA synchronous = FULL")
        self._database.execute(f"PRAGMA wal_autocheckpoint = {_LOG_PAGES}")
        (version,) = self._database.execute("PRAGMA user_version").fetchone()
        if version == 0:
            self._database.executescript(
                f"BEGIN IMMEDIATE; {_SCHEMA} PRAGMA user_version = {SCHEMA_VERSION}; COMMIT;"
            )
        elif version != SCHEMA_VERSION:
            # Programs that know only the old version cannot read what follows.
            self._database.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")

    @property
    def recording(self) -> bool:
        """Whether an episode is under way."""
        return self._episode is not None

    def begin_episode(self, header: EpisodeHeader) -> None:
        """Begin an episode; one that is still under way stays incomplete.

        Raises:
            JournalFullError: there is no room for another one.
            UserError: the journal cannot be written, or has gone.
        """
        self._episode = None
        self._watch.check()
        about = {
            **{one.name: getattr(header, one.name) for one in fields(header)},
            "limits": None if header.limits is None else limits_document(header.limits),
            "joint_limits": None if header.joint_limits is None else _limits_as_json(header.joint_limits),
            "goals": goals_document(header.goals),
            "provenance": provenance_json(header.provenance),
            "settings": dict(header.settings),
        }
        try:
            cursor = self._database.execute("INSERT INTO episodes (about) VALUES (?)", (json.dumps(about),))
            self._database.execute("PRAGMA synchronous = NORMAL")
        except sqlite3.Error as error:
            raise _unwritable(self._path, error) from error
        self._episode = cursor.lastrowid
        self._number = 0
        self._widths = ()
        self._things_width = STORED * len(header.things)
        self._sightings_width = 2 * len(header.things) if header.sources else 0
        self._samples_per_check = max(round(header.rate_hz), 1)

    def record(self, record: StepRecord) -> None:
        """Write one step; it is acknowledged when this returns.

        Raises:
            JournalFullError: there is no room for more; the episode was completed before this step.
            JournalLostError: the journal has gone, and the episode with it.
            UserError: the journal cannot be written (the disk is full; the episode then stays incomplete), or
                no episode is under way, the record's shapes differ from those before or from the header, or a
                figure of its gripper or of its things is not finite.
        """
        if self._episode is None:
            raise UserError(f"{self._path} has no episode under way: begin one before recording.")
        if self._number % self._samples_per_check == self._samples_per_check - 1:
            self.check()
        parts = figures_of(record)
        widths = tuple(len(part) for part in parts[:ALWAYS])
        about_things = record.things.size, record.sightings.size
        expected = self._things_width, self._sightings_width
        if (self._number and widths != self._widths) or about_things != expected:
            raise UserError(f"A record for {self._path} has other shapes than those before it.")
        if not all(np.isfinite(part).all() for part in parts[ALWAYS:]):
            raise UserError(
                f"A record for {self._path} has a gripper or things whose figures are not finite."
            )
        if self._number and np.array_equal(record.things, self._things):
            parts = without_things(parts)
        stop = record.command.stop
        row = (
            self._episode,
            self._number,
            packed(parts),
            None if stop is None else stop.reason,
            ",".join(record.command.limited_by),
        )
        try:
            self._database.execute("INSERT INTO samples VALUES (?, ?, ?, ?, ?)", row)
        except sqlite3.Error as error:
            # A sample is missing now: this episode can no longer become complete.
            self._episode = None
            raise _unwritable(self._path, error) from error
        self._widths, self._things = widths, record.things
        self._number += 1

    def check(self) -> None:
        """Check that the journal still exists and has room, when no samples are arriving.

        Raises:
            JournalFullError: there is no room for more; an episode under way was ended and is complete.
            JournalLostError: the journal has gone, and an episode under way with it.
            UserError: the journal cannot be written.
        """
        try:
            self._watch.check()
        except JournalFullError as error:
            if self._episode is not None and self._number:
                self.end_episode()
                error.ended_episode = True
            self._episode = None
            raise
        except UserError:
            self._episode = None
            raise

    def end_episode(self, device: str = "") -> None:
        """Flush everything to the disk and mark the episode complete.

        This waits for the disk, some hundred milliseconds after a long episode: end it when the arm is
        at rest.

        Args:
            device: kind of input device that was used, where that is only known now.

        Raises UserError where the journal cannot be written, or no episode is under way.
        """
        if self._episode is None:
            raise UserError(f"{self._path} has no episode under way: begin one before ending it.")
        try:
            # FULL: this commit waits until it, and so every sample before it in the log, is on the disk.
            self._database.execute("PRAGMA synchronous = FULL")
            if device:
                self._database.execute(
                    "UPDATE episodes SET about = json_set(about, '$.provenance.device', ?) WHERE id = ?",
                    (device, self._episode),
                )
            self._database.execute("UPDATE episodes SET complete = 1 WHERE id = ?", (self._episode,))
            self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        except sqlite3.Error as error:
            raise _unwritable(self._path, error) from error
        self._episode = None

    def drop_episode(self) -> None:
        """Delete the episode under way, where there is one.

        Raises UserError where the journal cannot be written; the episode then stays incomplete.
        """
        number, self._episode = self._episode, None
        try:
            self._database.execute("DELETE FROM samples WHERE episode = ?", (number,))
            self._database.execute("DELETE FROM episodes WHERE id = ?", (number,))
        except sqlite3.Error as error:
            raise _unwritable(self._path, error) from error

    def close(self) -> None:
        """Close the journal; an episode that is under way stays incomplete."""
        self._episode = None
        with suppress(sqlite3.Error):  # everything acknowledged is written already
            self._database.close()


def _limits_as_json(limits: JointLimits) -> dict[str, list[float]]:
    return {name: getattr(limits, name).tolist() for name in LIMIT_NAMES}


def check_is_journal(database: sqlite3.Connection, path: Path, *, may_be_empty: bool) -> None:
    """Check that an open database is our journal; UserError where it is not, or of a later version."""
    (version,) = database.execute("PRAGMA user_version").fetchone()
    (tables,) = database.execute("SELECT count(*) FROM sqlite_master").fetchone()
    if may_be_empty and version == 0 and tables == 0:
        return
    # Views, triggers and virtual tables would make SQLite run code from an untrusted file.
    (plain,) = database.execute(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND sql LIKE 'CREATE TABLE %'"
    ).fetchone()
    # Other programs use version numbers too; the tables show whose file it is.
    if (
        version in _READABLE
        and plain == tables == len(_COLUMNS)
        and all(
            [column for _, column, *_ in database.execute(f"PRAGMA table_info({table})")] == list(columns)
            for table, columns in _COLUMNS.items()
        )
    ):
        return
    raise UserError(f"{path} is not a journal of this program's version: choose another file.")


def _unwritable(path: Path, error: OSError | sqlite3.Error) -> UserError:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return UserError(f"The journal {path} cannot be written: {reason}.")
