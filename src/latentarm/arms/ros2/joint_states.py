"""Joint states as ROS tells them: in any order, of some joints, with the stamps of another clock."""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray

WINDOW: Final = 200
"""Over so many joint states the difference of the clocks is reckoned."""

JUMP_S: Final = 0.1
"""A clock that runs ahead by this at once has been set, s."""


class ClockJumpedError(Exception):
    """The stamps of joint states have jumped."""


class UnusableStatesError(Exception):
    """Joint states cannot be used; the text is one sentence."""


@final
@dataclass(frozen=True, eq=False)
class Measured:
    """Joint states of one moment.

    Attributes:
        stamp_s: on the clock of ROS, s.
        q: (n,), positions, rad.
        dq: (n,), velocities, rad/s.
    """

    stamp_s: float
    q: FloatArray
    dq: FloatArray


@final
class JointStates:
    """Picks the joints of an arm out of messages, by name.

    Args:
        joints: n names in ROS, in the order of the robot's joints.
        gripper_joint: the gripper's joint, which may come in messages of its own; "" without a gripper.

    Attributes:
        gripper: the newest position of the gripper's joint; None before there is one.
    """

    def __init__(self, joints: tuple[str, ...], gripper_joint: str) -> None:
        self._joints = joints
        self._gripper_joint = gripper_joint
        self.gripper: float | None = None

    def take(self, message: Mapping[str, Any]) -> Measured | None:
        """Read a ``sensor_msgs/JointState``.

        Returns:
            What the arm's joints did; None where the message is about others.

        Raises:
            UnusableStatesError: it names some of the arm's joints, but cannot be used.
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
        return Measured(
            stamp,
            _figures(message, "position", names, self._joints),
            _figures(message, "velocity", names, self._joints),
        )


@final
class StampClock:
    """When joint states were measured, on our clock, by their stamps on another one.

    The smallest difference between arrival and stamp in the last `WINDOW` messages is taken for that of the
    clocks: a message that the network held back is as old as it is.
    """

    def __init__(self) -> None:
        self._stamp_s = -math.inf
        self._differences: deque[float] = deque(maxlen=WINDOW)

    def time_of(self, stamp_s: float, arrived_s: float) -> float | None:
        """When it was measured, s.

        Args:
            stamp_s: on the clock of ROS, s.
            arrived_s: on ours, s.

        Returns:
            On our clock, s; None where the stamp repeats, so that nothing new was measured.

        Raises:
            ClockJumpedError: the other clock was set; what comes next is reckoned anew.
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
    """The figures of some joints, (len(wanted),); the caller must not change them."""
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
