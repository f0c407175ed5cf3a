"""What the control loop needs of an arm, real or simulated."""

from abc import ABC, abstractmethod

from latentarm.types import Command, FloatArray


class Arm(ABC):
    """An arm that is driven by joint velocities of bounded duration.

    An arm must come to rest by itself once a command's ``duration_s`` has passed without a new one.
    """

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
