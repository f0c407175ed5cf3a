"""Repeat the calls of an incident file, and compare every command."""

import json
import re
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any, Final, final
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.core.call_log import MOST_FILE_BYTES, answer_of, read_calls
from latentarm.core.errors import UserError
from latentarm.core.exact_json import of_json
from latentarm.core.types import FloatArray, GripperReading, Input, Reading, Stop
from latentarm.core.untrusted.opening import opened
from latentarm.robots.kinematics.obstacles import Box
from latentarm.web.arm_process import incident
from latentarm.web.arm_process.drive_setup import DriveSetup

ELSEWHERE_RAD_S: Final = 1e-9  # velocities may differ by this much on another computer, rad/s
_IN_REPORT: Final = re.compile(rf"{incident.FOLDER}/[\w-]+{re.escape(incident.SUFFIX)}")


@final
class Replay:
    """Repeats the calls of a drive's `Step` on another one."""

    def __init__(self, setup: DriveSetup) -> None:
        self.ticks = 0
        self.agreed = 0  # ticks with the same command, to the bit
        # the first call with another answer: its tick, when, s from the first one, both answers
        self.first: dict[str, Any] | None = None
        self.largest_rad_s = 0.0  # the largest difference of a velocity
        self.otherwise = False  # whether anything else differs
        self.happened: list[tuple[float, str]] = []  # events: when, s from the first tick, and in words
        self._modes = (*setup.controller.modes, "way to a pose")
        self._help, self._to_pose = setup.help, setup.to_pose()
        self._poses: deque[FloatArray] = deque()
        self._step = setup.step(self._poses.popleft if setup.controller.objects else None, self._to_pose)
        self._first_s: float | None = None
        self._time_s = 0.0
        self._was: tuple[str, ...] = ()

    def make(self, name: str, given: tuple[Any, ...], poses: tuple[FloatArray, ...], then: Any) -> None:
        """Make a call, as it was then, and compare the two answers, see `answer_of`."""
        self._poses.clear()
        self._poses.extend(poses)
        if ticks := name == "__call__":
            self._first_s = given[3] if self._first_s is None else self._first_s
            self._time_s = given[3] - self._first_s
        now = None
        try:
            for told in (self._step, self._help, self._to_pose):
                if hasattr(getattr(type(told), name, None), "__wrapped__"):
                    now = answer_of(getattr(told, name)(*given))
        except UserError:
            pass  # as it was then
        by_rad_s, otherwise = _differences(then, now)
        differs = otherwise or by_rad_s > 0.0
        if differs and self.first is None:
            self.first = {"tick": self.ticks, "time_s": self._time_s, "call": name, "then": then, "now": now}
        self.largest_rad_s = max(self.largest_rad_s, by_rad_s)
        self.otherwise |= otherwise
        self.ticks += ticks
        self.agreed += ticks and not differs
        self._look()

    def _look(self) -> None:
        stopped, help_ = self._step.stopped, self._help.level
        is_ = (
            "enabled" if stopped is None else f"stopped: {stopped.reason}",
            f"mode: {self._modes[self._step.mode]}{'' if help_ == 'off' else f', help: {help_}'}",
        )
        self.happened += [(self._time_s, one) for one in is_ if one not in self._was]
        self._was = is_


def _differences(then: Any, now: Any) -> tuple[float, bool]:
    if json.dumps(then) == json.dumps(now):
        return 0.0, False
    if not all(isinstance(one, dict) and "velocity" in one for one in (then, now)):
        return 0.0, True
    old, new = (of_json(each["velocity"]) for each in (then, now))
    return float(np.abs(old - new).max()), {**then, "velocity": 0} != {**now, "velocity": 0}


def replay_all(path: Path) -> dict[str, dict[str, Any]]:
    """Replay every incident file of a report, or else as `replay`; by the names of the files.

    Raises UserError as `replay`, and where a report has none, or is damaged.
    """
    if path.suffix != ".zip" or path.is_dir():
        file = incident.incident_files(path)[-1]
        return {file.name: replay(file)}
    try:
        with opened(path, 4 * MOST_FILE_BYTES) as content, ZipFile(content) as packed:
            files = [one for one in packed.infolist() if _IN_REPORT.fullmatch(one.filename)]
            if not files:
                raise UserError(f"{path} has no incident file: name one that `latentarm report` wrote.")
            return {Path(one.filename).name: _replay_packed(packed, one, path) for one in files}
    except (BadZipFile, OSError, NotImplementedError, RuntimeError) as error:
        raise UserError(f"{path} is damaged ({error}): copy it again.") from error


def _replay_packed(packed: ZipFile, file: ZipInfo, report: Path) -> dict[str, Any]:
    if file.compress_type != ZIP_STORED:
        raise UserError(
            f"{report} was packed by another program: name the file that `latentarm report` wrote."
        )
    with TemporaryDirectory() as folder, packed.open(file) as content:
        path = Path(folder) / Path(file.filename).name
        with path.open("wb") as copy:
            copyfileobj(content, copy)
        return replay(path)


def replay(path: Path) -> dict[str, Any]:
    """Replay an incident file.

    Returns the public attributes of `Replay`, with ``same``: whether the commands are the same as nearly as
    this computer can tell; ``then`` and ``here``: the computers; ``began_utc``; ``complete``: whether the
    file was closed. Raises UserError if it is none, is damaged, or names what is missing here or differs.
    """
    lines = read_calls(path)
    head, here, complete = next(lines), incident.computer(), False
    if head.get("incident") != incident.VERSION:
        raise UserError(f"{path} was written by another version of latentarm: replay it with that one.")
    again: Replay | None = None
    with TemporaryDirectory() as folder, threadpool_limits(1):
        for line in lines:
            if "file" in line:
                incident.unpack(line, Path(folder), str(path))
            elif "complete" in line:
                complete = True
            else:
                again = again or Replay(incident.rebuild(head, Path(folder), str(path)))
                _make(again, line, path)
    if again is None:
        raise UserError(f"{path} ends before the arm was told anything: there is nothing to replay.")
    found = {name: value for name, value in vars(again).items() if not name.startswith("_")}
    most_rad_s = 0.0 if here == head["computer"] else ELSEWHERE_RAD_S
    same = again.largest_rad_s <= most_rad_s and not again.otherwise
    about = {"same": same, "then": head["computer"], "here": here, "began_utc": head["began_utc"]}
    return {**about, "complete": complete, **found}


def _make(again: Replay, line: Mapping[str, Any], path: Path) -> None:
    kinds = (Input, Reading, GripperReading, Stop, Box)
    try:
        given, poses = of_json(line["given"], *kinds), of_json(line["seen"])
        again.make(line["call"], given, poses, line.get("answer"))
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f"{path} is damaged: a call after {again.ticks} ticks cannot be made.") from error
