"""Reading a journal, whole or cut short."""

import math
import sqlite3
from collections.abc import Collection, Generator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import NO_THINGS, Command, FloatArray, StepRecord, Stop
from latentarm.core.untrusted.documents import parse_object
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.core.untrusted.opening import check_file, is_missing
from latentarm.demonstrations.info import parse_goals
from latentarm.demonstrations.provenance import parse_provenance
from latentarm.recordings.journal_samples import (
    ALWAYS,
    COMPACT,
    gripper_command,
    gripper_reading,
    thing_poses,
    unpacked,
)
from latentarm.recordings.journal_writer import EpisodeHeader, check_is_journal
from latentarm.robots.limits import LIMIT_NAMES, JointLimits
from latentarm.robots.limits_file import parse_limits

_EARLIER = (math.nan, 1.0, 0.0)
"""The bound, the pace and what was added, in samples from before they were recorded."""

_SCALARS = 7
_LATER = 4
_MOST_FIGURES = 100_000
_MOST_CELL_BYTES = 1 << 20
_MOST_BYTES = 1 << 38  # of a journal: 256 GiB, which is days of driving


@final
@dataclass(frozen=True)
class JournalEpisode:
    """One recorded episode."""

    header: EpisodeHeader
    records: tuple[StepRecord, ...]
    complete: bool  # whether the recording was ended, rather than cut short


@final
@dataclass(frozen=True)
class JournalEntry:
    """One recorded episode in a journal's table of contents."""

    number: int  # for `read_journal`
    header: EpisodeHeader
    samples: int
    duration_s: float  # from its first sample to its last, s
    complete: bool  # whether the recording was ended, rather than cut short


def read_journal(path: Path, only: Collection[int] | None = None) -> list[JournalEpisode]:
    """The episodes of a journal, oldest first, or ``only`` these, with every acknowledged sample.

    The file is not changed; its ``-wal`` file, where one is left, belongs to it. ``only`` are numbers from
    `list_journal`. Raises UserError where there is no such file, it is damaged, or it is no journal.
    """
    with _opened(path) as database:
        (verdict,) = database.execute("PRAGMA quick_check(1)").fetchone()
        if verdict != "ok":
            raise UserError(f"The journal {path} is damaged ({verdict}): restore it from a copy.")
        rows = database.execute("SELECT id, about, complete FROM episodes ORDER BY id").fetchall()
        return [_episode(database, path, *row) for row in rows if only is None or row[0] in only]


def list_journal(path: Path) -> list[JournalEntry]:
    """A journal's table of contents, oldest episode first; quick, however long the episodes are.

    Raises UserError where there is no such file, it is damaged, or it is no journal.
    """
    with _opened(path) as database:
        rows = database.execute(
            "SELECT id, about, complete, (SELECT count(*) FROM samples WHERE episode = id)"
            " FROM episodes ORDER BY id"
        ).fetchall()
        return [
            JournalEntry(
                number=number,
                header=_checked_header(path, number, about),
                samples=samples,
                duration_s=_duration_s(database, path, number),
                complete=bool(complete),
            )
            for number, about, complete, samples in rows
        ]


@contextmanager
def _opened(path: Path) -> Generator[sqlite3.Connection]:
    """The database, to be read only; any error within becomes a `UserError`."""
    if is_missing(path):
        raise UserError(f"There is no journal {path}.")
    check_file(path, _MOST_BYTES)
    beside = [path.with_name(path.name + end) for end in ("-wal", "-shm", "-journal")]
    for file in beside:
        if not is_missing(file):
            check_file(file, _MOST_BYTES)
    # A journal that is being written has a log beside it. Without one, SQLite must know that
    # nobody writes, or it would leave a log of its own beside a damaged file.
    mode = "mode=ro&immutable=1" if is_missing(beside[0]) else "mode=ro"
    size = sum(one.stat().st_size for one in (path, beside[0]) if not is_missing(one))
    try:
        with (
            bounded_memory(f"The journal {path}", size),
            closing(sqlite3.connect(f"file:{_quoted(path)}?{mode}", uri=True)) as database,
        ):
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _MOST_CELL_BYTES)
            database.execute("PRAGMA trusted_schema = OFF")
            database.execute("PRAGMA cell_size_check = ON")
            check_is_journal(database, path, may_be_empty=False)
            yield database
    except sqlite3.Error as error:
        raise UserError(f"The journal {path} cannot be read ({error}): restore it from a copy.") from error


def _duration_s(database: sqlite3.Connection, path: Path, number: int) -> float:
    ends = database.execute(
        "SELECT figures, stop, limited_by FROM samples WHERE episode = :episode AND number IN ("
        "SELECT min(number) FROM samples WHERE episode = :episode UNION "
        "SELECT max(number) FROM samples WHERE episode = :episode) ORDER BY number",
        {"episode": number},
    ).fetchall()
    if not ends:
        return 0.0
    try:
        return _record(*ends[-1]).time_s - _record(*ends[0]).time_s
    except (ValueError, TypeError, AttributeError, OverflowError) as error:
        raise _damaged(path, number, error) from error


def _quoted(path: Path) -> str:
    """The path as SQLite's URIs want it."""
    return str(path.absolute()).replace("%", "%25").replace("?", "%3f").replace("#", "%23")


def _episode(db: sqlite3.Connection, path: Path, number: int, about: str, complete: int) -> JournalEpisode:
    samples = db.execute(
        "SELECT figures, stop, limited_by FROM samples WHERE episode = ? ORDER BY number", (number,)
    ).fetchall()
    header = _checked_header(path, number, about)
    try:
        records = _standing([_record(*sample) for sample in samples], header)
    except (ValueError, TypeError, AttributeError, OverflowError) as error:
        raise _damaged(path, number, error) from error
    return JournalEpisode(header, records, bool(complete))


def _checked_header(path: Path, number: int, about: str) -> EpisodeHeader:
    try:
        where = f"Episode {number} of the journal {path}"
        return _header(parse_object(about, where), where)
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError) as error:
        raise _damaged(path, number, error) from error


def _damaged(path: Path, number: int, error: Exception) -> UserError:
    return UserError(f"Episode {number} of the journal {path} is damaged ({error}).")


def _header(about: dict[str, Any], where: str) -> EpisodeHeader:
    header = EpisodeHeader(
        robot=str(about["robot"]),
        joint_names=tuple(str(name) for name in about["joint_names"]),
        rate_hz=float(about["rate_hz"]),
        task=str(about["task"]),
        modes=tuple(str(mode) for mode in about["modes"]),
        # Journals from before these were kept have neither.
        end_effector=None if about.get("end_effector") is None else str(about["end_effector"]),
        limits=None if about.get("limits") is None else parse_limits(about["limits"], "its limits"),
        goals=parse_goals(about["goals"], where),
        # Journals from before this was recorded have none.
        provenance=parse_provenance(about.get("provenance", {})),
        joint_limits=_joint_limits(about.get("joint_limits")),
        # Journals from before things were recorded have neither.
        things=_names(about.get("things", [])),
        objects=_names(about.get("objects", [])),
        sources=_names(about.get("sources", [])),
        settings=dict(about.get("settings", {})),
    )
    if not set(header.objects) <= set(header.things):
        raise ValueError("an object is not among the things")
    return header


def _names(listed: Any) -> tuple[str, ...]:
    names = tuple(str(name) for name in listed)
    if not all(names) or len(set(names)) != len(names):
        raise ValueError("two things have one name, or one has none")
    return names


def _joint_limits(limits: dict[str, Any] | None) -> JointLimits | None:
    """Limits of the joints; None in journals from before they were kept."""
    if limits is None:
        return None
    lower, upper, velocity, acceleration, jerk = (np.array(limits[name]) for name in LIMIT_NAMES)
    try:
        return JointLimits(lower, upper, velocity, acceleration, jerk)
    except UserError as error:
        raise ValueError(str(error)) from error


def _record(figures: bytes, stop: str | None, limited_by: str) -> StepRecord:
    if figures[:1] in COMPACT:
        return _step_record(unpacked(figures), stop, limited_by)
    values = np.frombuffer(figures, dtype=np.float64)
    widths = values[:ALWAYS]
    if len(widths) < ALWAYS or not (widths >= 0).all() or widths.sum() != len(values) - ALWAYS:
        raise ValueError("a sample has the wrong length")
    if len(values) > _MOST_FIGURES:
        raise ValueError("a sample is too long")
    parts = np.split(values[ALWAYS:], np.cumsum(widths.astype(np.int64))[:-1])
    return _step_record(parts, stop, limited_by)


def _step_record(parts: Sequence[FloatArray], stop: str | None, limited_by: str) -> StepRecord:
    scalars, state, given, latent, human, assist, belief, velocity, *later = parts
    # Journals from before grippers, things or their sources were recorded have no such parts.
    measured, asked, things, sightings = [*later, *[np.zeros(0)] * (_LATER - len(later))]
    missing = _SCALARS - len(scalars)
    known = [*scalars.tolist(), *_EARLIER[len(_EARLIER) - missing :]] if missing else scalars.tolist()
    time_s, alpha, mode, duration_s, bound_rad, pace, added = known
    if not 0.0 <= pace <= 1.0:
        raise ValueError("a sample has a pace outside [0, 1]")
    return StepRecord(
        time_s=time_s,
        state=state,
        input=given,
        latent=latent,
        action_human=human,
        action_assist=assist,
        alpha=alpha,
        belief=belief,
        mode=int(mode),
        command=Command(
            velocity=velocity,
            duration_s=duration_s,
            stop=None if stop is None else Stop(str(stop)),
            limited_by=tuple(limited_by.split(",")) if limited_by else (),
            gripper=gripper_command(asked),
        ),
        bound_rad=bound_rad,
        gripper=gripper_reading(measured),
        things=thing_poses(things),
        sightings=sightings.reshape(-1, 2),
        pace=pace,
        added=added,
    )


def _standing(records: Sequence[StepRecord], header: EpisodeHeader) -> tuple[StepRecord, ...]:
    """Records each with the poses of all things, where a sample leaves out those that have not moved."""
    newest, count = NO_THINGS, len(header.things)
    known = np.arange(-1, len(header.sources))
    standing: list[StepRecord] = []
    for record in records:
        newest = record.things if len(record.things) else newest
        if len(newest) != count:
            raise ValueError("a sample does not say where the things are")
        source, age_s = record.sightings.T
        if (
            len(source) != (count if header.sources else 0)
            or not (np.isin(source, known) & (age_s >= 0.0) & np.isfinite(age_s)).all()
        ):
            raise ValueError("a sample does not say from where the poses of things are")
        standing.append(replace(record, things=newest) if count else record)
    return tuple(standing)
