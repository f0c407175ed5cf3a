"""An arm whose encoders count: a reading is a whole number of counts."""

from collections.abc import Callable

import numpy as np

from latentarm.arms.simulated import SimulatedArm
from latentarm.arms.simulated_gripper import KinematicGripper
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot

COUNT_RAD = 1e-5


class CountingArm(SimulatedArm):
    """It does what it is told, and is read with finite resolution."""

    def __init__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> None:
        self._fingers = None if robot.gripper is None else KinematicGripper(robot.gripper)
        super().__init__(robot, state, now_s, rate_hz=200.0, stops_after_s=0.0, gripper=self._fingers)
        self._limits = robot.limits
        self._q = np.array(state, dtype=np.float64)
        self._dq = np.zeros(robot.dof)

    def _pass(self, span_s: float, commanded: FloatArray) -> None:
        moved = self._q + commanded * span_s
        self._q = np.clip(moved, self._limits.lower, self._limits.upper)
        self._dq = np.where(moved == self._q, commanded, 0.0)
        if self._fingers is not None:
            self._fingers.elapse(span_s)

    def _measure(self) -> tuple[FloatArray, FloatArray, float]:
        return np.round(self._q / COUNT_RAD) * COUNT_RAD, self._dq.copy(), 0.0

    def _halt(self) -> None:
        self._dq = np.zeros_like(self._dq)
