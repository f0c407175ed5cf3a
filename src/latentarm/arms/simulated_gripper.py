"""The base of simulated grippers, and one without inertia."""

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from latentarm.core.types import GripperCommand, GripperReading
from latentarm.robots.gripper import Gripper


class SimulatedGripper(ABC):
    """A gripper of a simulated arm. It begins open."""

    def __init__(self, gripper: Gripper) -> None:
        self.gripper = gripper

    @final
    def send(self, command: GripperCommand) -> None:
        """Take a command, cut to the gripper's limits; ValueError if a figure is not finite."""
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
        """Go to a width, m, with at most this speed, m/s, and this force, N."""

    @abstractmethod
    def halt(self) -> None:
        """Stay at the present opening, and keep holding."""

    @abstractmethod
    def measure(self) -> GripperReading:
        """The opening, and whether it holds something."""


@final
class KinematicGripper(SimulatedGripper):
    """A gripper that follows its commands, and never holds anything."""

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
        self._target_m = self._width_m

    def measure(self) -> GripperReading:
        return GripperReading(self._width_m)
