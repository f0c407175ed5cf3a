"""Joint states from ROS: in any order, of some joints, stamped by another clock."""

import math
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.options import Ros2Options
from latentarm.core.types import FloatArray

WINDOW: Final = 200  # joint states from which the difference of the clocks is estimated
JUMP_S: Final = 0.1  # a clock that jumps ahead by this has been set


class ClockJumpedError(Exception):
    """The stamps of joint states have jumped."""


class UnusableStatesError(Exception):
    """Joint states are unusable; the text is one sentence."""


@final
@dataclass(frozen=True, eq=False)
class Measured:
    """Joint states of one moment."""

    stamp_s: float  # on the clock of ROS, s
    q: FloatArray  # (n,), positions, rad
    dq: FloatArray  # (n,), velocities, rad/s


@final
class JointStates:
    """Picks an arm's joints out of messages by name; keeps the newest position of its ``gripper``."""

    def __init__(self, joints: tuple[str, ...], gripper_joint: str) -> None:
        self._joints, self._gripper_joint = joints, gripper_joint
        self.gripper: float | None = None

    def take(self, message: Mapping[str, Any]) -> Measured | None:
        """The arm's joints in a ``sensor_msgs/JointState``; None where the message is about others.

        Raises UnusableStatesError if it names some of the arm's joints, but cannot be used.
        """
        names = message.get("name")
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise UnusableStatesError("The joint states have no names.")
        if self._gripper_joint in names:
            at = _figures(message, "position", names, (self._gripper_joint,))
            self.gripper = float(at[0])
        missing = [joint for joint in self._joints if joint not in names]
        if len(missing) == len(self._joints):
            return None
        if missing:
            raise UnusableStatesError(
                f"The joint states lack {', '.join(missing)}: check the joints of --arm."
            )
        if len(set(names)) < len(names):
            raise UnusableStatesError("The joint states name a joint twice: end one of their publishers.")
        stamp = _stamp(message)
        q, dq = (_figures(message, entry, names, self._joints) for entry in ("position", "velocity"))
        return Measured(stamp, q, dq)


@final
class StampClock:
    """Converts stamps of joint states to our clock.

    The smallest difference between arrival and stamp in the last `WINDOW` messages counts as that of the
    clocks: this reveals the age of messages that the network held back.
    """

    def __init__(self) -> None:
        self._stamp_s = -math.inf
        self._differences: deque[float] = deque(maxlen=WINDOW)

    def time_of(self, stamp_s: float, arrived_s: float) -> float | None:
        """Time of measurement on our clock, s; None for a repeated stamp, where nothing is new.

        Raises ClockJumpedError if the other clock was set; what comes next is reckoned anew.
        """
        if stamp_s == self._stamp_s:
            return None
        difference_s = arrived_s - stamp_s
        back = stamp_s < self._stamp_s
        ahead = bool(self._differences) and difference_s < min(self._differences) - JUMP_S
        self._stamp_s = stamp_s
        if back or ahead:
            self._differences.clear()
            raise ClockJumpedError
        self._differences.append(difference_s)
        return min(stamp_s + min(self._differences), arrived_s)


def _stamp(message: Mapping[str, Any]) -> float:
    header = message.get("header")
    stamp = header.get("stamp") if isinstance(header, Mapping) else None
    if not isinstance(stamp, Mapping):
        raise UnusableStatesError("The joint states have no stamp.")
    sec, nanosec = stamp.get("sec"), stamp.get("nanosec")
    if not isinstance(sec, int) or not isinstance(nanosec, int) or abs(sec) >= 1 << 53:
        raise UnusableStatesError("The joint states have no stamp.")
    return sec + 1e-9 * nanosec


def _figures(
    message: Mapping[str, Any], entry: str, names: Sequence[str], wanted: tuple[str, ...]
) -> FloatArray:
    """Figures of some joints, (len(wanted),); the caller must not change them."""
    figures = message.get(entry)
    if not isinstance(figures, list) or len(figures) != len(names):
        raise UnusableStatesError(
            f"The joint states have no {entry} for each joint: add the state interface {entry}."
        )
    chosen = [figures[names.index(joint)] for joint in wanted]
    # rosbridge says null where a figure is not a number.
    if not all(isinstance(x, int | float) and not isinstance(x, bool) and math.isfinite(x) for x in chosen):
        raise UnusableStatesError(f"The joint states have a {entry} that is not a finite number.")
    found = np.array(chosen, dtype=np.float64)
    found.flags.writeable = False
    return found


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
