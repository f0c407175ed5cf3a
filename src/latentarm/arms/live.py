"""A simulated arm that runs in real time."""

from collections.abc import Callable
from typing import final

from latentarm.arms.contract import Arm, SimulatedArm
from latentarm.types import Command, FloatArray


@final
class LiveArm(Arm):
    """A simulated arm that moves as time passes, even if the control loop is late.

    So it stops by itself once a command has expired, as a real one must.

    Args:
        arm: what moves; nothing else may let time pass for it.
        now_s: the time that it lives in, s; never goes back.
    """

    def __init__(self, arm: SimulatedArm, now_s: Callable[[], float]) -> None:
        self._arm = arm
        self._now_s = now_s
        self._at_s = now_s()

    @property
    def simulated(self) -> bool:
        """True."""
        return True

    def state(self) -> FloatArray:
        """See the base class."""
        return self._current().state()

    def velocity(self) -> FloatArray:
        """See the base class."""
        return self._current().velocity()

    def send(self, command: Command) -> None:
        """See the base class."""
        self._current().send(command)

    def stop(self) -> None:
        """See the base class."""
        self._current().stop()

    def _current(self) -> SimulatedArm:
        """The arm as it is by now."""
        now_s = self._now_s()
        if now_s > self._at_s:
            self._arm.advance(now_s - self._at_s)
        self._at_s = now_s
        return self._arm
