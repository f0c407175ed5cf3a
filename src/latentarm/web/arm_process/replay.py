"""Deciding again what an incident file says that an arm was told, and comparing every command."""

import json
import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.control.call_log import answer_of, read_calls
from latentarm.control.exact_json import of_json
from latentarm.control.step import Step
from latentarm.errors import UserError
from latentarm.types import FloatArray, GripperReading, Input, Reading, Stop
from latentarm.web.arm_process.drive_setup import DriveSetup
from latentarm.web.arm_process.incident import computer, rebuild, unpack

ELSEWHERE_RAD_S: Final = 1e-9
"""On another kind of computer commands may differ by so much, rad/s."""

_KINDS: Final[dict[str, type]] = {kind.__name__: kind for kind in (Input, Reading, GripperReading, Stop)}


@final
@dataclass
class Replay:
    """How a replay went.

    Attributes:
        recorded: latentarm's version and the platform where the arm was driven.
        here: the same of this computer.
        began_utc: when the drive began, ISO 8601.
        complete: whether the file was closed, rather than cut off.
        ticks: how many commands there were.
        agreed: how many calls in a row, from the first, were answered the same, to the bit.
        calls: how many calls there were.
        first: the first that was answered otherwise: its tick, time from the first tick in s, name, and both
            answers; None where there is none.
        largest_rad_s: the largest difference of a velocity; infinite where anything else differs.
        happened: what happened: time from the first tick, s, and words.
    """

    recorded: dict[str, str]
    here: dict[str, str]
    began_utc: str
    complete: bool = False
    ticks: int = 0
    agreed: int = 0
    calls: int = 0
    first: dict[str, Any] | None = None
    largest_rad_s: float = 0.0
    happened: list[tuple[float, str]] = field(default_factory=list)

    @property
    def same(self) -> bool:
        """Whether the commands are those of the drive, as nearly as this computer can tell."""
        most = 0.0 if self.here == self.recorded else ELSEWHERE_RAD_S
        return self.first is None or self.largest_rad_s <= most


def replay(path: Path) -> Replay:
    """Replay an incident file.

    Raises:
        UserError: it is none, is damaged, or names what is missing here or differs.
    """
    lines = read_calls(path)
    head = next(lines)
    if head.get("incident") != 1:
        raise UserError(f"{path} was written by another version of latentarm: replay it with that one.")
    here = computer()
    done = Replay({key: str(head.get(key)) for key in here}, here, str(head.get("began_utc")))
    again: _Again | None = None
    with TemporaryDirectory() as folder, threadpool_limits(1):
        for line in lines:
            if "file" in line:
                unpack(line, Path(folder), str(path))
            elif "complete" in line:
                done.complete = True
            else:
                again = again or _Again(rebuild(head, Path(folder), str(path)), done)
                try:
                    again.make(line)
                except (KeyError, TypeError, ValueError, AttributeError) as error:
                    what = f"call {done.calls + 1} cannot be made ({error!r})"
                    raise UserError(f"{path} is damaged: {what}.") from error
    if again is None:
        raise UserError(f"{path} ends before the arm was told anything: there is nothing to replay.")
    return done


@final
class _Again:
    """The `Step` of a drive, which is told everything again."""

    def __init__(self, setup: DriveSetup, done: Replay) -> None:
        self._modes = (*setup.controller.modes, "way to a pose")
        self._help, self._to_pose = setup.help, setup.to_pose()
        self._poses: deque[FloatArray] = deque()
        looks = self._poses.popleft if setup.controller.objects else None
        self._step = setup.step(looks, self._to_pose)
        self._done = done
        self._first_s: float | None = None
        self._time_s = 0.0
        self._told: tuple[object, ...] = ()

    def make(self, line: Mapping[str, Any]) -> None:
        """Make a call and compare its answer."""
        name, given = str(line["call"]), of_json(line["given"], _KINDS)
        self._poses.clear()
        self._poses.extend(of_json(line["seen"], _KINDS))
        if name == "__call__":
            self._done.ticks += 1
            now_s = float(given[3])
            self._first_s = now_s if self._first_s is None else self._first_s
            self._time_s = now_s - self._first_s
        answer = None
        try:
            if name == "level":
                self._help.level = given[0]
            elif name == "lead_to":
                self._to_pose.lead_to(*given)
            elif hasattr(vars(Step)[name], "__wrapped__"):
                answer = answer_of(getattr(self._step, name)(*given))
        except UserError:
            pass  # refused, as it was then
        self._compare(name, line["answer"], answer)
        self._tell()

    def _compare(self, name: str, then: Any, now: Any) -> None:
        done = self._done
        done.calls += 1
        difference = _difference(then, now)
        done.largest_rad_s = max(done.largest_rad_s, difference)
        if difference and done.first is None:
            done.first = {"tick": done.ticks, "time_s": self._time_s, "call": name, "then": then, "now": now}
        done.agreed += done.first is None

    def _tell(self) -> None:
        """Note what a person would want to know of this call."""
        step = self._step
        help_ = "" if self._help.level == "off" else f", help: {self._help.level}"
        state = "enabled" if step.stopped is None else f"stopped: {step.stopped.reason}"
        told = (state, f"mode: {self._modes[step.mode]}{help_}")
        news = [one for one in told if one not in self._told]
        self._done.happened += [(self._time_s, one) for one in news]
        self._told = told


def _difference(then: Any, now: Any) -> float:
    """How far apart two answers are, rad/s: 0 where they are the same to the bit."""
    if json.dumps(then) == json.dumps(now):
        return 0.0
    old, new = _without_words(then), _without_words(now)
    if isinstance(old, dict) and isinstance(new, dict) and "velocity" in old and "velocity" in new:
        one, other = (of_json(each.pop("velocity"), {}) for each in (old, new))
        if old == new and np.shape(one) == np.shape(other):
            return float(np.abs(one - other).max())
    return 0.0 if json.dumps(old) == json.dumps(new) else math.inf


def _without_words(answer: Any) -> Any:
    """An answer's fields, with the code of a stop in place of its sentence, where it has one."""

    def kept(part: dict[str, Any]) -> Any:
        fields = part.get("fields", part)
        return fields.get("code") or fields.get("reason") if part.get("record") == "Stop" else fields

    return json.loads(json.dumps(answer), object_hook=kept)
