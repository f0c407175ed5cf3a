"""The joint states of an arm as they come in, timed by our clock."""

import time
from collections.abc import Callable, Mapping
from typing import Any, Final, final

from latentarm.arms.ros2.joint_states import (
    ClockJumpedError,
    JointStates,
    Measured,
    StampClock,
    UnusableStatesError,
)
from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.options import Ros2Options

_KIND: Final = "sensor_msgs/msg/JointState"


@final
class JointFeed:
    """Subscribes to the joint states; everything here is kept by roslibpy's thread and read by others.

    Args:
        link: the connection.
        options: which joints, where.
        now_s: our clock, s.

    Attributes:
        newest: what was measured last, and when on our clock, s; None before there is anything.
        count: how many were new.
        repeats: how many had the stamp of the one before.
        trouble: why the last message about the arm could not be used; "" where it could.
        jumped: whether the clock of the stamps was set since somebody last made this False.
        ahead_s: the newest stamp less the time of day on this computer when it came, s.
    """

    def __init__(self, link: Link, options: Ros2Options, now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._states = JointStates(options.joints, options.gripper_joint)
        self._clock = StampClock()
        self.newest: tuple[Measured, float] | None = None
        self.count = self.repeats = 0
        self.trouble = ""
        self.jumped = False
        self.ahead_s = 0.0
        link.subscribe(options.states, _KIND, self._heard)

    @property
    def gripper(self) -> float | None:
        """The newest position of the gripper's joint; None before there is one."""
        return self._states.gripper

    def _heard(self, message: Mapping[str, Any]) -> None:
        arrived_s = self._now_s()
        try:
            measured = self._states.take(message)
            if measured is None:
                return
            self.trouble = ""
            time_s = self._clock.time_of(measured.stamp_s, arrived_s)
        except UnusableStatesError as error:
            self.trouble = str(error)
            return
        except ClockJumpedError:
            self.jumped = True
            return
        if time_s is None:
            self.repeats += 1
            return
        self.ahead_s = measured.stamp_s - time.time()
        self.count += 1
        self.newest = (measured, time_s)
