"""What the control loop needs of an arm, real or simulated."""

from abc import ABC, abstractmethod
from typing import final

from latentarm.errors import UserError
from latentarm.robots.notices import assumed_limits
from latentarm.robots.robot import Robot
from latentarm.types import Command, FloatArray


class Arm(ABC):
    """An arm that is driven by joint velocities of bounded duration.

    An arm must come to rest by itself once a command's ``duration_s`` has passed without a new one.
    """

    @property
    @abstractmethod
    def simulated(self) -> bool:
        """Whether the arm is simulated; `check_limits` is stricter for a real one."""

    @abstractmethod
    def state(self) -> FloatArray:
        """(n,), measured joint positions, rad."""

    @abstractmethod
    def velocity(self) -> FloatArray:
        """(n,), measured joint velocities, rad/s."""

    @abstractmethod
    def send(self, command: Command) -> None:
        """Take a command; it replaces the one before."""

    @abstractmethod
    def stop(self) -> None:
        """Stop now and forget the last command."""


class SimulatedArm(Arm):
    """A simulated arm. Its time passes only in `advance`."""

    @property
    @final
    def simulated(self) -> bool:
        """True."""
        return True

    @abstractmethod
    def advance(self, dt_s: float) -> None:
        """Let time pass.

        Args:
            dt_s: how long, s.

        Raises:
            UserError: ``dt_s`` is not finite or not above zero.
        """


def check_limits(arm: Arm, robot: Robot) -> None:
    """Refuse to drive a real arm within assumed limits.

    Args:
        arm: what is to be driven.
        robot: what is known of it.

    Raises:
        UserError: the arm is real, and one of its limits is assumed.
    """
    assumed = assumed_limits(robot)
    if assumed and not arm.simulated:
        raise UserError(
            f"{robot.name} is a real arm, and its {assumed} is not known but assumed: state the"
            " manufacturer's figures in a file and name it with --limits FILE."
        )
