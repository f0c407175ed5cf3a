"""The log of the drive under way, from reports and inputs.

It does nothing slow, as every report goes through it. `Logged.trace` does the slow part.
"""

from collections import Counter
from dataclasses import dataclass, field
from math import dist
from typing import Final, final

import numpy as np

from latentarm.web.arm_process.drive_setup import DriveSetup
from latentarm.web.protocol.report import Report, Things
from latentarm.web.protocol.scene import Drawable, pose_of
from latentarm.web.records.drive_record import DriveRecord, Ending, Mark, Trace, TracedThings
from latentarm.web.records.record_files import new_id, stamp

PERIOD_S: Final = 0.1  # moments of a trace are at least this far apart, s
MOST_VALUES: Final = 200_000
"""Values in a trace; a longer drive keeps every second moment, repeatedly if need be."""

GRAINS_S: Final = 1.0  # grains are traced this often, s: there may be thousands
LATE: Final = "input_late"  # code of a stop for a late input
_ENABLED: Final = ("ready", "moving")
_LONGEST_TICK_S: Final = 0.5
_DIGITS: Final = 4


@final
@dataclass(frozen=True)
class About:
    """The setup of a drive, and the driver's id (None for a guest)."""

    person: str | None
    setup: DriveSetup
    run: str | None  # its name
    scene: Drawable


@final
@dataclass(frozen=True)
class _Moment:
    t: float
    q: tuple[float, ...]
    tool: tuple[float, float, float]
    u: tuple[float, ...]
    width_m: float | None


@dataclass
class _Open:
    about: About
    first: Report
    started: str
    id: str = field(default_factory=new_id)
    last: Report | None = None
    enabled_s: float = 0.0
    moving_s: float = 0.0
    way_m: float = 0.0
    help_s: float = 0.0
    modes: Counter[str] = field(default_factory=Counter[str])
    inputs: Counter[str] = field(default_factory=Counter[str])
    input_s: dict[str, float] = field(default_factory=dict[str, float])
    reasons: Counter[str] = field(default_factory=Counter[str])
    presses: int = 0
    period_s: float = PERIOD_S
    moments: list[_Moment] = field(default_factory=list[_Moment])
    things: list[TracedThings] = field(default_factory=list[TracedThings])
    marks: list[Mark] = field(default_factory=list[Mark])
    grains_s: float = -GRAINS_S
    values: int = 0

    @property
    def over(self) -> bool:
        """Whether the task has ended: the rest of the drive is replayed, but not counted."""
        return self.last is not None and self.last.task.outcome is not None


@final
@dataclass(frozen=True)
class Logged:
    """A drive that has ended."""

    record: DriveRecord  # its figures; without the scene, which has not been kept yet
    _drive: _Open

    @property
    def scene(self) -> Drawable:
        return self._drive.about.scene

    def trace(self) -> Trace:
        """The trace to replay; takes some milliseconds for each minute."""
        moments = self._drive.moments
        chain = self._drive.about.setup.task.robot.chain
        links = chain.link_transforms(np.array([moment.q for moment in moments]))
        bodies = [pose_of(np.concatenate([np.eye(4)[None], row])) for row in links]
        return Trace(
            period_s=self._drive.period_s,
            t=tuple(moment.t for moment in moments),
            q=tuple(moment.q for moment in moments),
            tool=tuple(moment.tool for moment in moments),
            bodies=tuple(
                tuple((x, y, z, w, i, j, k) for x, y, z, w, i, j, k in np.round(row, _DIGITS).tolist())
                for row in bodies
            ),
            u=tuple(moment.u for moment in moments),
            width_m=tuple(moment.width_m for moment in moments),
            things=tuple(self._drive.things),
            marks=tuple(self._drive.marks),
        )


@final
class DriveLog:
    """Logs one drive after the other."""

    def __init__(self) -> None:
        self._open: _Open | None = None
        self._u: tuple[float, ...] = ()
        self._source = ""
        self._standing: Things | None = None

    @property
    def under_way(self) -> About | None:
        return None if self._open is None else self._open.about

    def begins(self, report: Report) -> bool:
        """Whether a drive begins with this report: `begin` is due then."""
        self._standing = report.things or self._standing
        return self._open is None and report.phase in _ENABLED

    def begin(self, report: Report, about: About) -> None:
        """Begin with a report of an enabled arm."""
        self._open = _Open(about, report, stamp())
        self._note_things(self._open, self._standing, 0.0)
        self.take(report)

    def take(self, report: Report) -> bool:
        """Take a report; ignored while no drive is under way. True if the task has ended with it."""
        drive = self._open
        if drive is None:
            return False
        t = round(report.time_s - drive.first.time_s, 2)
        before = drive.last
        enabled, was = report.phase in _ENABLED, before is not None and before.phase in _ENABLED
        going = not drive.over
        if before is not None and going:
            span_s = min(max(report.time_s - before.time_s, 0.0), _LONGEST_TICK_S)
            drive.way_m += dist(report.tool, before.tool)
            if was and before.phase == "moving":
                drive.moving_s += span_s
                drive.help_s += span_s * before.alpha
            if was:
                drive.enabled_s = t
                drive.modes[before.mode] += 1
                if any(self._u):
                    drive.input_s[self._source] = drive.input_s.get(self._source, 0.0) + span_s
        if was and not enabled:
            code = "stop_pressed" if report.reason is None else report.reason.code
            drive.reasons[code] += going
            drive.marks.append(Mark(t=t, code=code))
        elif enabled and not was:
            drive.marks.append(Mark(t=t, code="enabled"))
        drive.last = report
        if report.things is not None:
            self._note_things(drive, report.things, t)
        self._trace(drive, report, t)
        return going and drive.over

    def given(self, u: tuple[float, ...], source: str, *, gripper: bool) -> None:
        """Note an input with a kind of device; ``gripper``: whether it is a request to the gripper."""
        pressed = (any(u) and not any(self._u)) + gripper
        self._u, self._source = tuple(round(value, 2) for value in u), source
        if self._open is not None and pressed and not self._open.over:
            self._open.presses += pressed
            self._open.inputs[source] += pressed

    def so_far(self) -> DriveRecord | None:
        """The record of the drive under way if everything stopped now; None without one."""
        drive = self._open
        return None if drive is None or drive.last is None else _record(drive, drive.last, "broken_off")

    def end(self, why: Ending) -> Logged | None:
        """End the drive under way; None if no drive has begun."""
        drive, self._open = self._open, None
        self._u = ()
        if why == "run_changed":
            self._standing = None
        if drive is None or drive.last is None:
            return None
        t = round(drive.last.time_s - drive.first.time_s, 2)
        if not drive.moments or drive.moments[-1].t < t:
            self._keep_moment(drive, drive.last, t)
        return Logged(_record(drive, drive.last, why), drive)

    def _trace(self, drive: _Open, report: Report, t: float) -> None:
        newest = drive.moments[-1] if drive.moments else None
        if newest is not None:
            if t - newest.t < drive.period_s:
                return
            if _moment(report, self._u, newest.t) == newest:
                return
        self._keep_moment(drive, report, t)

    def _keep_moment(self, drive: _Open, report: Report, t: float) -> None:
        moment = _moment(report, self._u, t)
        drive.moments.append(moment)
        drive.values += len(moment.q) * 8 + 8
        if drive.values > MOST_VALUES:
            drive.period_s *= 2.0
            drive.moments = drive.moments[::2]
            drive.things = _halved(drive.things)
            drive.values //= 2

    def _note_things(self, drive: _Open, things: Things | None, t: float) -> None:
        if things is None or (drive.things and t - drive.things[-1].t < drive.period_s):
            return
        newest = next((one.grains for one in reversed(drive.things) if one.grains is not None), None)
        grains = things.grains if t - drive.grains_s >= GRAINS_S and things.grains != newest else None
        if drive.things and grains is None and drive.things[-1].poses == things.poses:
            return
        if grains is not None:
            drive.grains_s = t
        drive.things.append(TracedThings(t=t, poses=things.poses, grains=grains))
        drive.values += 7 * len(things.poses) + sum(map(len, grains or ()))


def _record(drive: _Open, last: Report, why: Ending) -> DriveRecord:
    first, about = drive.first, drive.about
    setup, todo = about.setup, about.setup.todo
    return DriveRecord.model_validate(
        {
            "id": drive.id,
            "person": about.person,
            "started": drive.started,
            "time_s": round(max(drive.enabled_s, 0.0), 2),
            "moving_s": round(min(drive.moving_s, drive.enabled_s), 2),
            "robot": setup.task.robot.name[:200],
            "real": setup.real,
            "task": todo.task[:200],
            "choice": todo.choices[last.task.choice][:200] if todo.choices else None,
            "run": None if about.run is None else about.run[:200],
            "profile": None if first.profile is None else first.profile[:64],
            "modes": tuple(mode for mode, _ in drive.modes.most_common()) or (first.mode,),
            "inputs": tuple(source for source, _ in drive.inputs.most_common()),
            "input_s": {source: round(spent_s, 2) for source, spent_s in drive.input_s.items()},
            "presses": drive.presses,
            "stops": drive.reasons.total(),
            "late_stops": drive.reasons[LATE],
            "reasons": dict(drive.reasons),
            "way_m": round(drive.way_m, 3),
            "help": round(min(drive.help_s / drive.moving_s, 1.0), 3) if drive.moving_s else None,
            "help_level": last.help,
            "steps_done": last.task.done if todo.steps else None,
            "steps": len(todo.steps) or None,
            "outcome": last.task.outcome,
            "why": None if last.task.why is None else last.task.why.code,
            "ended": why,
            "scene": None,
        }
    )


def _halved(things: list[TracedThings]) -> list[TracedThings]:
    """Every second state after the first, each with the newest grains, so that none is lost."""
    pairs = zip(things[1::2], things[2::2], strict=False)
    halved = [later.model_copy(update={"grains": later.grains or sooner.grains}) for sooner, later in pairs]
    return [*things[:1], *halved, *(things[-1:] if len(things) > 1 and len(things) % 2 == 0 else ())]


def _moment(report: Report, u: tuple[float, ...], t: float) -> _Moment:
    x, y, z = (round(value, _DIGITS) for value in report.tool)
    q = tuple(round(value, _DIGITS) for value in report.q)
    width = None if report.gripper is None else round(report.gripper.width_m, _DIGITS)
    return _Moment(t, q, (x, y, z), u, width)
