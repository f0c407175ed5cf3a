"""A simulated arm that lives in real time."""

from typing import final

from latentarm.arms.contract import Arm
from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import Clock
from latentarm.robots.robot import Robot
from latentarm.types import Command, FloatArray


@final
class LiveArm(Arm):
    """A simulated arm that moves as time passes, whether or not anybody is late.

    So it stops by itself once a command has run out, as a real one must.

    Args:
        robot: whose joints these are.
        state: (n,), where it starts, rad.
        clock: the time that it lives in.

    Raises:
        UserError: see `KinematicArm`.
    """

    def __init__(self, robot: Robot, state: FloatArray, clock: Clock) -> None:
        self._arm = KinematicArm(robot, state, dt_s=1.0)
        self._clock = clock
        self._at_s = clock.now_s()

    @property
    def simulated(self) -> bool:
        """True."""
        return True

    def state(self) -> FloatArray:
        """See the base class."""
        return self._now().state()

    def velocity(self) -> FloatArray:
        """See the base class."""
        return self._now().velocity()

    def send(self, command: Command) -> None:
        """See the base class."""
        self._now().send(command)

    def stop(self) -> None:
        """See the base class."""
        self._now().stop()

    def _now(self) -> KinematicArm:
        """The arm as it is by now."""
        now_s = self._clock.now_s()
        if now_s > self._at_s:
            self._arm.advance(now_s - self._at_s)
        self._at_s = now_s
        return self._arm
