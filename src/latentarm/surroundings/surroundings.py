"""The things about an arm for the loop: seen by sources, touched by a person, carried by the tool."""

import math
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, GripperReading, Pose
from latentarm.robots.scene.thing import Part, Thing
from latentarm.surroundings import touch
from latentarm.surroundings.catalogue import TOUCH
from latentarm.surroundings.process import Inbox
from latentarm.surroundings.tracker import Tracker


@final
class Surroundings:
    """Follows things from tick to tick.

    Args:
        things: with their shapes, and the height and tilt with which they stand if ``stand``.
        stand: whether they stand where a task says; otherwise a touch also tells the height.
        sightings: from a `SourceProcess`, or None.
    """

    def __init__(self, things: Sequence[Thing], *, stand: bool, sightings: Connection | None) -> None:
        self.tracker = Tracker(thing.name for thing in things)
        self._standing = {thing.name: thing.pose for thing in things if stand}
        self._grasp = Grasp(things)
        self._inbox = None if sightings is None else Inbox(sightings)
        self._tool: Pose | None = None

    def update(self, tool: Pose | None, gripper: GripperReading | None, now_s: float) -> None:
        """Take what is new, once a tick; ``tool`` is None where the joints could not be read."""
        self._tool = tool
        if self._inbox is not None:
            for one in self._inbox.read(now_s):
                self.tracker.saw(one.sighting, one.source, one.hold_s, now_s)
        self.tracker.update(tool, now_s)
        if tool is not None:
            self._grasp.update(self.tracker, tool, gripper, now_s)

    def touch(self, name: str, kind: touch.TouchKind, now_s: float) -> bool:
        """Take a person's word about a thing, with the tool where it is; False where it cannot be taken."""
        tracker = self.tracker
        if name not in tracker.names or self._tool is None:
            return False
        if kind == "undo":
            return tracker.take_back(name)
        if kind == "place":
            said = touch.placed(name, self._standing.get(name), self._tool, now_s)
        else:
            pose = tracker.look(name, now_s).pose
            said = None if pose is None else touch.turned(name, pose, self._tool, now_s)
        if said is not None:
            tracker.place(said, TOUCH, touch.HOLD_S)
        return said is not None

    def rows(self, names: Sequence[str], now_s: Callable[[], float]) -> Callable[[], FloatArray]:
        """A function that returns the poses of these things at the time of the call."""
        return lambda: self.tracker.rows(names, now_s())


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
        self._solids = {thing.name: _bounds(thing.parts) for thing in movable}
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


def _bounds(parts: Sequence[Part]) -> tuple[FloatArray, FloatArray]:
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
