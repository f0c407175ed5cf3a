"""Where a person brings the tool next: the waypoints of a task's steps, at the person's pace."""

from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.steps import RETRY_S, TaskStep, Waypoint
from latentarm.web.protocol.report import Point, ToGo

_METRES: Final = 4
_RADIANS: Final = 3  # digits that pages receive


@final
class WaypointGuide:
    """Leads from one waypoint of a step to the next.

    For simulated drives the clock leads on from a waypoint at which the gripper closes. Here the person does,
    and may take their time.
    """

    def __init__(self) -> None:
        self._step: TaskStep | None = None
        self._index = 0
        self._arrived_s: float | None = None

    @property
    def waypoint(self) -> Waypoint | None:
        """The tool's present target; None where nothing is left, or before the first look."""
        return None if self._step is None else self._step.waypoints[self._index]

    def look(self, step: TaskStep | None, state: SceneState) -> ToGo | None:
        """The remaining way in the step; None where nothing is left to do. ``state`` has a running clock."""
        if step is not self._step:
            self._step = step
            self._index, self._arrived_s = 0, None
        if step is None:
            return None
        self._go_on(step.waypoints, state)
        waypoint = step.waypoints[self._index]
        pose, tool = waypoint.pose(state), state.tool
        return ToGo(
            shift_m=_point(pose.position - tool.position, _METRES),
            turn_rad=_point(rotation_vector(tool.rotation.T @ pose.rotation), _RADIANS),
            gripper=None if self._arrived_s is None else _still_asked(waypoint, state),
        )

    def _go_on(self, waypoints: tuple[Waypoint, ...], state: SceneState) -> None:
        waypoint = waypoints[self._index]
        if self._arrived_s is None and waypoint.reached(state):
            self._arrived_s = state.time_s
        looked_for = waypoint.until is None or waypoint.until(state)
        if self._arrived_s is None or _still_asked(waypoint, state) is not None or not looked_for:
            return
        last = self._index == len(waypoints) - 1
        if state.time_s - self._arrived_s >= (RETRY_S if last else waypoint.wait_s):
            self._index = 0 if last else self._index + 1
            self._arrived_s = None


def _still_asked(waypoint: Waypoint, state: SceneState) -> Literal["open", "close"] | None:
    match waypoint.gripper:
        case "close" if not state.gripped:
            return "close"
        case "open" if state.gripped:
            return "open"
        case _:
            return None


def _point(vector: FloatArray, digits: int) -> Point:
    x, y, z = np.round(vector, digits).tolist()
    return x, y, z
