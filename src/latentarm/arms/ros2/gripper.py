"""A gripper behind a ``control_msgs/GripperCommand`` action."""

from collections.abc import Mapping
from typing import Any, Final, final

import numpy as np

from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.options import Ros2Options
from latentarm.core.types import GripperCommand, GripperReading
from latentarm.robots.gripper import Gripper

_ACTION: Final = "control_msgs/action/GripperCommand"
_SUCCEEDED, _CANCELED = 4, 5  # of ``action_msgs/GoalStatus``
_SAME_M: Final = 5e-4
_HOLDS_M: Final = 2e-3  # fingers that stall this far before their goal hold something, m


@final
class Ros2Gripper:
    """Sends new goals, and keeps their outcome; ``failure`` says why the last failed, or ""."""

    def __init__(self, link: Link, options: Ros2Options, gripper: Gripper) -> None:
        self._link, self._options, self._gripper = link, options, gripper
        self._goal: str | None = None
        self._told: tuple[float, float] | None = None
        self._holding = False
        self.failure = ""

    def command(self, command: GripperCommand) -> None:
        """Go to a width, unless it is the last goal already. The action has no speed; 0 halts.

        Raises ValueError if a figure is not finite: no safety filter sends that.
        """
        if not np.isfinite((command.width_m, command.speed_m_s, command.force_n)).all():
            raise ValueError("a command to a gripper needs a finite width, speed and force")
        if command.speed_m_s <= 0.0:
            self.halt()
            return
        width_m = float(np.clip(command.width_m, 0.0, self._gripper.width_m))
        force_n = float(np.clip(command.force_n, 0.0, self._gripper.force_n))
        told = self._told
        if told is not None and abs(told[0] - width_m) < _SAME_M and told[1] == force_n:
            return
        self._told, self._holding, self.failure = (width_m, force_n), False, ""
        goal = {"command": {"position": self._position(width_m), "max_effort": force_n}}
        sent: list[str | None] = []

        def ended(result: Mapping[str, Any]) -> None:
            self._ended(sent, width_m, result)

        sent.append(self._link.send_goal(self._options.gripper, _ACTION, goal, ended, ended))
        self._goal = sent[0]

    def halt(self) -> None:
        """Stay at the present opening, and keep holding."""
        goal, self._goal = self._goal, None
        if goal is not None:
            self._link.cancel_goal(self._options.gripper, goal)
            self._told = None

    def measured(self, position: float) -> GripperReading:
        """The reading for a position of the gripper's joint."""
        opened, closed = self._options.gripper_open, self._options.gripper_closed
        return GripperReading(self._gripper.width_m * (position - closed) / (opened - closed), self._holding)

    def _position(self, width_m: float) -> float:
        opened, closed = self._options.gripper_open, self._options.gripper_closed
        return closed + (opened - closed) * width_m / self._gripper.width_m

    def _ended(self, sent: list[str | None], width_m: float, result: Mapping[str, Any]) -> None:
        """In roslibpy's thread: a goal was reached, given up, or refused."""
        status, values = result.get("status"), result.get("values")
        number = getattr(status, "value", None)
        if not sent or sent[0] != self._goal or number == _CANCELED:
            return  # another goal has replaced it
        self._goal = None
        told = values.get("result", values) if isinstance(values, Mapping) else {}
        stalled = isinstance(told, Mapping) and told.get("stalled") is True
        position = told.get("position") if isinstance(told, Mapping) else None
        if stalled and isinstance(position, int | float):
            self._holding = self.measured(float(position)).width_m > width_m + _HOLDS_M
        elif number != _SUCCEEDED:
            self.failure = "The gripper did not do what it was told: look at its controller."
