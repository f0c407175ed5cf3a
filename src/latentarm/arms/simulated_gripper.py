"""What the grippers of simulated arms have in common, and one without inertia."""

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from latentarm.core.types import GripperCommand, GripperReading
from latentarm.robots.gripper import Gripper


class SimulatedGripper(ABC):
    """A gripper of a simulated arm. It begins open.

    Args:
        gripper: what its manufacturer states.
    """

    def __init__(self, gripper: Gripper) -> None:
        self.gripper = gripper

    @final
    def send(self, command: GripperCommand) -> None:
        """Take a command, cut to what the gripper can do.

        Raises:
            ValueError: a figure is not finite: no safety filter sends that.
        """
        figures = (command.width_m, command.speed_m_s, command.force_n)
        if not np.isfinite(figures).all():
            raise ValueError("a command to a gripper needs a finite width, speed and force")
        if command.speed_m_s <= 0.0:
            self.halt()
            return
        most = self.gripper.width_m, self.gripper.speed_m_s, self.gripper.force_n
        self._aim(*(float(np.clip(figure, 0.0, top)) for figure, top in zip(figures, most, strict=True)))

    @abstractmethod
    def _aim(self, width_m: float, speed_m_s: float, force_n: float) -> None:
        """Go to a width, m, no faster than this, m/s, and press no harder than this, N."""

    @abstractmethod
    def halt(self) -> None:
        """Stay at the present opening; what is held is still held."""

    @abstractmethod
    def measure(self) -> GripperReading:
        """How far it is open, and whether it holds something."""


@final
class KinematicGripper(SimulatedGripper):
    """It opens and closes as it is told, and there is nothing that it could hold."""

    def __init__(self, gripper: Gripper) -> None:
        super().__init__(gripper)
        self._width_m = self._target_m = gripper.width_m
        self._speed_m_s = 0.0

    def elapse(self, span_s: float) -> None:
        """Let time pass, s."""
        most = self._speed_m_s * span_s
        self._width_m += float(np.clip(self._target_m - self._width_m, -most, most))

    def _aim(self, width_m: float, speed_m_s: float, force_n: float) -> None:
        self._target_m, self._speed_m_s = width_m, speed_m_s

    def halt(self) -> None:
        """See the base class."""
        self._target_m = self._width_m

    def measure(self) -> GripperReading:
        """See the base class."""
        return GripperReading(self._width_m)
