"""The incoming joint states of an arm, timed by our clock."""

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
    """Subscribes to the joint states; roslibpy's thread writes its attributes, others read them."""

    def __init__(self, link: Link, options: Ros2Options, now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._states = JointStates(options.joints, options.gripper_joint)
        self._clock = StampClock()
        # the last measurement, and its time on our clock, s; None at first
        self.newest: tuple[Measured, float] | None = None
        self.count = 0  # of new ones
        self.repeats = 0  # of those with the stamp of the one before
        self.trouble = ""  # why the last message about the arm was unusable, or ""
        self.jumped = False  # whether the clock of the stamps was set; readers reset this
        self.ahead_s = 0.0  # the newest stamp less this computer's time of day at arrival, s
        link.subscribe(options.states, _KIND, self._heard)

    @property
    def gripper(self) -> float | None:
        """The newest position of the gripper's joint; None at first."""
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
