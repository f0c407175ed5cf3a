"""The record of a drive: its figures, and a thin trace to replay it."""

import zlib
from typing import Annotated, Final, Literal

from pydantic import Field, ValidationError, model_validator

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Message, NoticeCode
from latentarm.web.protocol.orders import ModeName
from latentarm.web.protocol.report import Point, PoseRow
from latentarm.web.records.people import PersonId
from latentarm.web.records.record_files import ID

TRACE_LIMIT: Final = 1 << 26  # the largest trace, unpacked, bytes
PACKED_LIMIT: Final = 1 << 24  # the largest compressed trace, bytes

DriveId = Annotated[str, Field(pattern=rf"^{ID.pattern}$")]
SceneId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
Count = Annotated[int, Field(ge=0, le=2**31)]
Seconds = Annotated[float, Field(ge=0.0, le=1e9)]
InputKind = Annotated[str, Field(max_length=20)]
Text = Annotated[str, Field(max_length=200)]
Stopper = Literal["person", "page", "arm"]
Ending = Literal["reset", "again", "next", "driver_changed", "run_changed", "server_ended", "broken_off"]

_BY_PERSON: Final[frozenset[NoticeCode]] = frozenset(
    {
        "arm_emergency_stop", "copilot_began", "copilot_changed", "copilot_ended", "driver_changed",
        "driver_released", "emergency_stop_released", "handed_over", "question_began", "stop_pressed",
        "stop_pressed_by",
    }
)  # fmt: skip
_BY_PAGE: Final[frozenset[NoticeCode]] = frozenset(
    {
        "copilot_gone", "copilot_late", "driver_expired", "driver_gone", "input_late", "latch_ended",
        "message_invalid", "page_stopped",
    }
)  # fmt: skip
"""Codes of stops; the arm, its program or its safety limits cause all others."""


class DriveRecord(Message):
    """One drive: a run of a task, from when the arm is first enabled until the person ends it or leaves.

    Nothing is counted after the task has succeeded or failed.
    """

    version: Literal[1] = 1
    id: DriveId
    person: PersonId | None  # who drove; None for a guest
    title: Annotated[str, Field(max_length=80)] = ""  # given by people; "" for none
    # when the arm was first enabled, ISO 8601 in UTC
    started: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00$")]
    time_s: Seconds  # from then until the task ended, or else until the arm was last enabled
    moving_s: Seconds  # for how long of that the arm moved
    robot: Text
    real: bool = False  # whether the arm was real
    task: Text
    choice: Text | None = None  # the chosen food or cup; None where there was no choice
    run: Text | None  # its name; None without one
    profile: Annotated[str, Field(max_length=64)] | None  # whose alignment was used; None for none
    modes: Annotated[tuple[ModeName, ...], Field(max_length=8)]
    # kinds of device, the most often pressed first
    inputs: Annotated[tuple[InputKind, ...], Field(max_length=8)]
    # how long each kind of device was pushed while the arm was enabled, s; None where nobody measured that
    input_s: Annotated[dict[InputKind, Seconds], Field(max_length=8)] | None = None
    presses: Count  # how often the input left neutral, or the gripper got a request
    stops: Count  # how often the arm was disengaged while it was enabled
    late_stops: Count  # those for a late input
    # number of stops by code
    reasons: Annotated[dict[Annotated[str, Field(max_length=60)], Count], Field(max_length=60)]
    way_m: Annotated[float, Field(ge=0.0, le=1e9)]  # length of the tool's path, m
    # the robot's share of the motion, averaged while the arm moved; None if it never moved
    help: Annotated[float, Field(ge=0.0, le=1.0)] | None
    help_level: Annotated[str, Field(max_length=20)] | None = None  # None where there is no choice
    steps_done: Count | None = None  # steps of the task that were done; None where the task is not watched
    steps: Count | None = None  # of the task; None as above
    # None where it was given up or the task is not watched
    outcome: Literal["success", "failure"] | None = None
    why: Annotated[str, Field(max_length=60)] | None = None  # code of why it failed; None if it did not
    # what ended it; ``broken_off`` if the server or the arm's process was killed, and the end of the drive
    # is unknown
    ended: Ending
    scene: SceneId | None  # its id; None where no trace is kept

    @property
    def stops_by(self) -> dict[Stopper, int]:
        """How often each stopped the arm: a person, the page or its computer, and the arm itself."""
        counts: dict[Stopper, int] = {"person": 0, "page": 0, "arm": 0}
        for code, count in self.reasons.items():
            counts["person" if code in _BY_PERSON else "page" if code in _BY_PAGE else "arm"] += count
        return counts


class TracedThings(Message):
    """Where things are from time ``t`` on, s since the drive began; ``grains`` is None if unchanged."""

    t: float
    poses: tuple[PoseRow, ...]
    grains: tuple[tuple[float, ...], ...] | None


class Mark(Message):
    """An event at a time, s since the drive began: a code."""

    t: float
    code: Annotated[str, Field(max_length=60)]


class Trace(Message):
    """A drive to be replayed: N moments, ten a second or fewer, none where nothing changed."""

    version: Literal[1] = 1
    # moments are at least this far apart, but for the last; where they are further, nothing changed until
    # then
    period_s: Annotated[float, Field(gt=0.0, le=1e4)]
    t: tuple[float, ...]  # N times, s since the drive began
    q: tuple[tuple[float, ...], ...]  # N rows of joint positions, rad
    tool: tuple[Point, ...]  # N positions, m
    bodies: tuple[tuple[PoseRow, ...], ...]  # N rows of poses in the order of the scene's description
    u: tuple[tuple[float, ...], ...]  # N inputs
    width_m: tuple[float | None, ...]  # N openings of the gripper, m; None without one
    things: tuple[TracedThings, ...]  # when they had moved
    marks: tuple[Mark, ...]

    @model_validator(mode="after")
    def _same_length(self) -> "Trace":
        columns = (self.q, self.tool, self.bodies, self.u, self.width_m)
        if any(len(column) != len(self.t) for column in columns):
            raise ValueError("the columns of a trace have several lengths")
        if any(later < sooner for sooner, later in zip(self.t, self.t[1:], strict=False)):
            raise ValueError("the times of a trace go back")
        return self


def packed(trace: Trace) -> bytes:
    """The trace as JSON, compressed with gzip."""
    packer = zlib.compressobj(6, wbits=31)
    return packer.compress(trace.model_dump_json().encode()) + packer.flush()


def checked_trace(content: bytes, where: str) -> Trace:
    """Unpack and check a trace. Raises UserError, with ``where``, if it is damaged, too large, or none."""
    unpacker = zlib.decompressobj(wbits=31)
    try:
        document = unpacker.decompress(content, TRACE_LIMIT)
        if not unpacker.eof or unpacker.unused_data:
            raise UserError(f"{where} is cut short or larger than {TRACE_LIMIT:,} bytes.")
        return Trace.model_validate_json(document)
    except (zlib.error, ValidationError) as error:
        raise UserError(f"{where} is not the trace of a drive, or is damaged.") from error
