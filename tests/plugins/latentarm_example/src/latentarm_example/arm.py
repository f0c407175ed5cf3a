"""An arm whose encoders count: a reading is a whole number of counts."""

import numpy as np

from latentarm.arms.contract import SimulatedArm
from latentarm.arms.kinematic import KinematicArm
from latentarm.robots.robot import Robot
from latentarm.types import Command, FloatArray

COUNT_RAD = 1e-5


class CountingArm(SimulatedArm):
    """The kinematic arm, read with finite resolution."""

    def __init__(self, robot: Robot, state: FloatArray) -> None:
        self._arm = KinematicArm(robot, state)

    def state(self) -> FloatArray:
        return np.round(self._arm.state() / COUNT_RAD) * COUNT_RAD

    def velocity(self) -> FloatArray:
        return self._arm.velocity()

    def send(self, command: Command) -> None:
        self._arm.send(command)

    def stop(self) -> None:
        self._arm.stop()

    def advance(self, dt_s: float) -> None:
        self._arm.advance(dt_s)
