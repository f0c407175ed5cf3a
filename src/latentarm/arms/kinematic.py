"""An arm without inertia: it follows every command, and stops by itself when commands end."""

import math
from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.arms.simulated import SimulatedArm
from latentarm.arms.simulated_gripper import KinematicGripper
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot

RATE_HZ: Final = 1000.0  # as fast as any loop


@final
class KinematicArm(SimulatedArm):
    """Kinematic simulation of the paper's transition, ``s' = s + a dt``.

    A joint that reaches a limit stays there, as at a hard stop. A gripper follows its commands. ``state``
    (n,), rad, is the start. Raises UserError where it has the wrong shape, is not finite, or lies outside the
    limits.
    """

    def __init__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> None:
        self._fingers = None if robot.gripper is None else KinematicGripper(robot.gripper)
        super().__init__(
            robot, state, now_s, rate_hz=RATE_HZ, stops_after_s=0.0, gripper=self._fingers, settles_s=math.inf
        )
        self._limits = robot.limits
        self._state = np.array(state, dtype=np.float64)
        self._velocity = np.zeros(robot.dof)

    def _pass(self, span_s: float, commanded: FloatArray) -> None:
        moved = self._state + commanded * span_s
        self._state = np.clip(moved, self._limits.lower, self._limits.upper)
        self._velocity = np.where(moved == self._state, commanded, 0.0)
        if self._fingers is not None:
            self._fingers.elapse(span_s)

    def _measure(self) -> tuple[FloatArray, FloatArray, float]:
        return self._state.copy(), self._velocity.copy(), 0.0

    def _halt(self) -> None:
        self._velocity = np.zeros_like(self._velocity)
