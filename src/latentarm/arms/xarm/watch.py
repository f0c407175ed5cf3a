"""Detects faults in the joint reports while the arm is enabled."""

from typing import Final, final

import numpy as np

from latentarm.arms.xarm.controller import JOINT_VELOCITY, STATES_THAT_MOVE
from latentarm.arms.xarm.reports import JointReport
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.stillness import STILL_RAD_S

_FROZEN_S: Final = 0.12  # a joint moves after so long a command, whatever its lag
_COMMANDED_RAD_S: Final = 0.02  # slower commands do not count for that
_SETTLED_S: Final = 0.5  # an arm stands still so long after its last command
_UNTOLD_RAD_S: Final = 5.0 * STILL_RAD_S
_AGAIN: Final = "then enable the arm again"


@final
class Watch:
    """Compares reports with commands."""

    def __init__(self, joint_names: tuple[str, ...]) -> None:
        self._names = joint_names
        n = len(joint_names)
        self._q: FloatArray | None = None
        self._since_s = np.zeros(n)
        self._command_ends_s = 0.0

    def reset(self, now_s: float) -> None:
        """Begin again for an arm that has just been enabled; the time is the monotonic clock's, s."""
        self._q = None
        self._command_ends_s = now_s

    def commanded(self, velocity: FloatArray, ends_s: float) -> None:
        """Note a command (n,), rad/s, and its end on the monotonic clock, s."""
        slow = np.abs(velocity) < _COMMANDED_RAD_S
        self._since_s[slow] = ends_s
        if np.abs(velocity).max() > 0.0:
            self._command_ends_s = ends_s

    def fault(self, report: JointReport) -> str:
        """Why driving must end after the newest report, one sentence, or ""."""
        if not np.isfinite(report.q).all() or not np.isfinite(report.dq).all():
            return f"The arm reports joint angles that are no numbers: restart its controller, {_AGAIN}."
        if report.mode != JOINT_VELOCITY or report.state not in STATES_THAT_MOVE:
            return (
                f"Another program has taken over the arm (mode {report.mode}, state {report.state}): close"
                f" it, or UFACTORY Studio's control page, {_AGAIN}."
            )
        if (
            report.arrived_s > self._command_ends_s + _SETTLED_S
            and (speed := float(np.abs(report.dq).max())) > _UNTOLD_RAD_S
        ):
            return (
                f"The arm moves at {speed:.2g} rad/s without having been told to: another program may be"
                f" driving it; close it, {_AGAIN}."
            )
        return self._frozen(report)

    def _frozen(self, report: JointReport) -> str:
        changed = np.ones(len(report.q), dtype=np.bool_) if self._q is None else report.q != self._q
        self._q = report.q
        self._since_s[changed] = np.maximum(self._since_s[changed], report.arrived_s)
        if report.arrived_s > self._command_ends_s:
            self._since_s[:] = report.arrived_s
        still_s = report.arrived_s - self._since_s
        joint = int(np.argmax(still_s))
        if still_s[joint] < _FROZEN_S:
            return ""
        return (
            f"The angle of joint {self._names[joint]!r} does not change although it was told to move:"
            f" restart the arm's controller, {_AGAIN}."
        )
