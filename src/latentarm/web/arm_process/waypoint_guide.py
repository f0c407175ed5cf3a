"""Where a person brings the tool next: the waypoints of a task's steps, at the person's pace."""

from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.steps import PATIENCE_S, RETRY_S, TaskStep, Waypoint
from latentarm.web.protocol.report import Point, ToGo

_METRES: Final = 4
_RADIANS: Final = 3  # digits that pages receive
_LEAST_M: Final = 0.003
_LEAST_RAD: Final = 0.05  # pages list no smaller way
_LEFT: Final = 3.0  # a tool that is so many tolerances off has left the waypoint
_CLOSED_M: Final = 0.002  # fingers that are no farther apart hold nothing
_SPILLS_RAD: Final = 0.5  # a vessel that is tilted by more may lose what is in it


@final
class WaypointGuide:
    """Leads from one waypoint of a step to the next.

    For simulated drives the clock leads on from a waypoint at which the gripper closes. Here the person does,
    and may take their time. A vessel is first turned upright and then carried: people turn last, and it would
    go on pouring. ``vessels`` are the things that are poured from.
    """

    def __init__(self, vessels: frozenset[str] = frozenset()) -> None:
        self._vessels = vessels
        self._step: TaskStep | None = None
        self._index = 0
        self._arrived_s: float | None = None
        self._closes_s: float | None = None  # since when the gripper has closed with nothing in it, s
        self._empty = False  # whether it has missed
        self._still_s: float | None = None  # since when nothing is left to be driven to the waypoint, s

    @property
    def waypoint(self) -> Waypoint | None:
        """The tool's present target; None where nothing is left, or before the first look."""
        return None if self._step is None else self._step.waypoints[self._index]

    def look(self, step: TaskStep | None, state: SceneState, closing_m: float | None = None) -> ToGo | None:
        """The remaining way in the step; None where nothing is left to do.

        ``state`` has a running clock. ``closing_m`` is the distance of the gripper's fingers, m, if its last
        command was to close.
        """
        if step is not self._step:
            self._step = step
            self._index, self._arrived_s = 0, None
        if closing_m is None or state.gripped:
            self._closes_s, self._empty = None, False
        else:
            self._closes_s = state.time_s if self._closes_s is None else self._closes_s
            self._empty = closing_m <= _CLOSED_M or state.time_s - self._closes_s >= PATIENCE_S
        if step is None:
            return None
        self._go_on(step.waypoints, state)
        waypoint = step.waypoints[self._index]
        shift_m, turn_rad = _left(waypoint, state)
        upright = step.holds not in self._vessels or _untilts_rad(step.holds, waypoint, state) < _SPILLS_RAD
        return ToGo(
            shift_m=_point(shift_m, _METRES) if upright else (0.0, 0.0, 0.0),
            turn_rad=_point(turn_rad, _RADIANS),
            gripper=self._asked(waypoint, state),
        )

    def _go_on(self, waypoints: tuple[Waypoint, ...], state: SceneState) -> None:
        waypoint = waypoints[self._index]
        if self._arrived_s is None and waypoint.reached(state):
            self._arrived_s = state.time_s
        elif self._asked(waypoint, state) == "close" and waypoint.missed_by(state) > _LEFT:
            # The arm has drawn back from a force, or was driven on: there is nothing to close on.
            self._arrived_s = None
        true = waypoint.until is None or waypoint.until(state)
        if self._in_vain(waypoint, state, true=true):
            self._index, self._arrived_s, self._still_s = 0, None, None
        if self._arrived_s is None or self._asked(waypoint, state) is not None or not true:
            return
        last = self._index == len(waypoints) - 1
        if state.time_s - self._arrived_s >= (RETRY_S if last else waypoint.wait_s):
            self._index = 0 if last else self._index + 1
            self._arrived_s = None

    def _in_vain(self, waypoint: Waypoint, state: SceneState, *, true: bool) -> bool:
        """Return True if the step cannot go on: the grip missed, or no way is left without ``true``."""
        if waypoint.gripper == "close":
            return self._empty
        shift_m, turn_rad = _left(waypoint, state)
        if true or np.abs(shift_m).max() >= _LEAST_M or np.abs(turn_rad).max() >= _LEAST_RAD:
            self._still_s = None
        elif self._still_s is None:
            self._still_s = state.time_s
        return self._still_s is not None and state.time_s - self._still_s >= PATIENCE_S

    def _asked(self, waypoint: Waypoint, state: SceneState) -> Literal["open", "close"] | None:
        if self._arrived_s is None:
            # Shut fingers would push away the thing that they are to take.
            return "open" if waypoint.gripper is not None and self._empty else None
        if waypoint.gripper == "close":
            return None if state.gripped else "close"
        return "open" if waypoint.gripper == "open" and (state.gripped or self._empty) else None


def _left(waypoint: Waypoint, state: SceneState) -> tuple[FloatArray, FloatArray]:
    """The way to a waypoint: a shift in the base frame, m, and a turn about the tool's own axes, rad."""
    pose, tool = waypoint.pose(state), state.tool
    return pose.position - tool.position, rotation_vector(tool.rotation.T @ pose.rotation)


def _untilts_rad(held: str, waypoint: Waypoint, state: SceneState) -> float:
    """How much less a held thing is tilted at the waypoint than now, rad."""
    axis = state.poses[held].rotation[:, 2]
    there = waypoint.pose(state).rotation @ state.tool.rotation.T @ axis
    now_rad, there_rad = np.arccos(np.clip([axis[2], there[2]], -1.0, 1.0))
    return float(now_rad - there_rad)


def _point(vector: FloatArray, digits: int) -> Point:
    x, y, z = np.round(vector, digits).tolist()
    return x, y, z
