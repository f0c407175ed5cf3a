"""Detects what the tool carries: a thing between the fingers, or food on the fork."""

import math
from collections.abc import Sequence
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, GripperReading, Pose
from latentarm.robots.scene.thing import Part, Thing
from latentarm.surroundings.tracker import Tracker

REACH_M: Final = 0.03  # farthest from a thing's solids that fingers which hold something hold it
RELEASED_S: Final = 0.3  # fingers that hold nothing for so long have let go


@final
class Grasp:
    """Tells a `Tracker` what the tool carries.

    Fingers that begin to hold something hold the nearest movable thing, if one is within `REACH_M` of the
    tool's point. Without a gripper, the tool carries food that its point has entered.
    """

    def __init__(self, things: Sequence[Thing]) -> None:
        movable = [thing for thing in things if not thing.fixed]
        self._solids = {thing.name: bounds(thing.parts) for thing in movable}
        self._food = [thing.name for thing in movable if thing.food is not None]
        self._holding = False
        self._held_s = -math.inf

    def update(self, tracker: Tracker, tool: Pose, gripper: GripperReading | None, now_s: float) -> None:
        """Take what the arm says, once a tick, after `Tracker.update`."""
        if gripper is None:
            for name in self._food:
                if name not in tracker.carried and self._away(tracker, name, tool, now_s) == 0.0:
                    tracker.carry(name, sensed=False)
            return
        if gripper.holding:
            self._held_s = now_s
            if not self._holding:
                self._take(tracker, tool, now_s)
        elif now_s - self._held_s > RELEASED_S:
            for name in [name for name, sensed in tracker.carried.items() if sensed]:
                tracker.let_go(name, now_s)
        self._holding = now_s - self._held_s <= RELEASED_S

    def _take(self, tracker: Tracker, tool: Pose, now_s: float) -> None:
        away = {name: self._away(tracker, name, tool, now_s) for name in self._solids}
        nearest = min(away, key=away.__getitem__, default=None)
        if nearest is not None and away[nearest] <= REACH_M:
            tracker.carry(nearest, sensed=True)

    def _away(self, tracker: Tracker, name: str, tool: Pose, now_s: float) -> float:
        """Distance from the tool's point to a thing's solids, m; infinite for an unseen thing."""
        pose = tracker.look(name, now_s).pose
        if pose is None:
            return math.inf
        lower, upper = self._solids[name]
        point = (tool.position - pose.position) @ pose.rotation
        return float(np.linalg.norm(np.maximum(np.maximum(lower - point, point - upper), 0.0)))


def bounds(parts: Sequence[Part]) -> tuple[FloatArray, FloatArray]:
    """The corners (3,) of a box about solids, in the frame of their thing, m."""
    middles = np.array([part.position for part in parts]).reshape(-1, 3)
    half = np.array([_half(part) for part in parts]).reshape(-1, 3)
    return (middles - half).min(axis=0), (middles + half).max(axis=0)


def _half(part: Part) -> FloatArray:
    size = part.size
    match part.shape:
        case "box":
            half = np.array(size)
        case "sphere":
            half = np.full(3, size[0])
        case "cylinder":
            half = np.array([size[0], size[0], size[1]])
        case "capsule":
            half = np.array([size[0], size[0], size[0] + size[1]])
    turn = Rotation.from_quat(part.quaternion, scalar_first=True).as_matrix()
    return np.abs(turn) @ half
