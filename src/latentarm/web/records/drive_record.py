"""The record of a drive: its figures, and a thin trace to replay it."""

import zlib
from typing import Annotated, Final, Literal, final

from pydantic import Field, ValidationError, model_validator

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Message
from latentarm.web.protocol.orders import ModeName
from latentarm.web.protocol.report import Point, PoseRow
from latentarm.web.records.documents import ID
from latentarm.web.records.people import PersonId

TRACE_LIMIT: Final = 1 << 26
"""The largest trace, unpacked, bytes."""

PACKED_LIMIT: Final = 1 << 24
"""The largest compressed trace, bytes."""

DriveId = Annotated[str, Field(pattern=rf"^{ID.pattern}$")]
SceneId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
Count = Annotated[int, Field(ge=0, le=2**31)]
Seconds = Annotated[float, Field(ge=0.0, le=1e9)]
Text = Annotated[str, Field(max_length=200)]
Ending = Literal["reset", "again", "next", "driver_changed", "run_changed", "server_ended", "broken_off"]


@final
class DriveRecord(Message):
    """One drive: a run of a task, from when the arm is first enabled until the person ends it or leaves.

    Nothing is counted after the task has succeeded or failed.

    Attributes:
        person: who drove; None for a guest.
        title: given by people; "" for none.
        started: when the arm was first enabled, ISO 8601 in UTC.
        time_s: from then until the task ended, or else until the arm was last enabled.
        moving_s: for how long of that the arm moved.
        real: whether the arm was real.
        choice: the chosen food or cup; None where there was no choice.
        run: its name; None without one.
        profile: whose alignment was used; None for none.
        inputs: kinds of device, the most used first.
        presses: how often the input left neutral, or the gripper got a request.
        stops: how often the arm was disengaged while it was enabled.
        late_stops: those for a late input.
        reasons: number of stops by code.
        way_m: length of the tool's path, m.
        help: the robot's share of the motion, averaged while the arm moved; None if it never moved.
        help_level: None where there is no choice.
        steps_done: steps of the task that were done; None where the task is not watched.
        steps: of the task; None as above.
        outcome: None where it was given up or the task is not watched.
        why: code of why it failed; None if it did not.
        ended: what ended it; ``broken_off`` if the server or the arm's process was killed, and the end of the
            drive is unknown.
        scene: its id; None where no trace is kept.
    """

    version: Literal[1] = 1
    id: DriveId
    person: PersonId | None
    title: Annotated[str, Field(max_length=80)] = ""
    started: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00$")]
    time_s: Seconds
    moving_s: Seconds
    robot: Text
    real: bool = False
    task: Text
    choice: Text | None = None
    run: Text | None
    profile: Annotated[str, Field(max_length=64)] | None
    modes: Annotated[tuple[ModeName, ...], Field(max_length=8)]
    inputs: Annotated[tuple[Annotated[str, Field(max_length=20)], ...], Field(max_length=8)]
    presses: Count
    stops: Count
    late_stops: Count
    reasons: Annotated[dict[Annotated[str, Field(max_length=60)], Count], Field(max_length=60)]
    way_m: Annotated[float, Field(ge=0.0, le=1e9)]
    help: Annotated[float, Field(ge=0.0, le=1.0)] | None
    help_level: Annotated[str, Field(max_length=20)] | None = None
    steps_done: Count | None = None
    steps: Count | None = None
    outcome: Literal["success", "failure"] | None = None
    why: Annotated[str, Field(max_length=60)] | None = None
    ended: Ending
    scene: SceneId | None


@final
class TracedThings(Message):
    """Where things are from time ``t`` on, s since the drive began; ``grains`` is None if unchanged."""

    t: float
    poses: tuple[PoseRow, ...]
    grains: tuple[tuple[float, ...], ...] | None


@final
class Mark(Message):
    """An event at a time, s since the drive began: a code."""

    t: float
    code: Annotated[str, Field(max_length=60)]


@final
class Trace(Message):
    """A drive to be replayed: N moments, ten a second or fewer, none where nothing changed.

    Attributes:
        period_s: moments are at least this far apart, but for the last; where they are further, nothing
            changed until then.
        t: N times, s since the drive began.
        q: N rows of joint positions, rad.
        tool: N positions, m.
        bodies: N rows of poses in the order of the scene's description.
        u: N inputs.
        width_m: N openings of the gripper, m; None without one.
        things: when they had moved.
    """

    version: Literal[1] = 1
    period_s: Annotated[float, Field(gt=0.0, le=1e4)]
    t: tuple[float, ...]
    q: tuple[tuple[float, ...], ...]
    tool: tuple[Point, ...]
    bodies: tuple[tuple[PoseRow, ...], ...]
    u: tuple[tuple[float, ...], ...]
    width_m: tuple[float | None, ...]
    things: tuple[TracedThings, ...]
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
    """Unpack and check a trace from `packed`; errors call it ``where``.

    Raises:
        UserError: it is damaged, too large, or no trace.
    """
    unpacker = zlib.decompressobj(wbits=31)
    try:
        document = unpacker.decompress(content, TRACE_LIMIT)
        if not unpacker.eof or unpacker.unused_data:
            raise UserError(f"{where} is cut short or larger than {TRACE_LIMIT:,} bytes.")
        return Trace.model_validate_json(document)
    except (zlib.error, ValidationError) as error:
        raise UserError(f"{where} is not the trace of a drive, or is damaged.") from error
