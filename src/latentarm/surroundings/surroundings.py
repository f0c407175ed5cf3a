"""The things about an arm for the loop: seen by sources, touched by a person, carried by the tool."""

from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import final

from latentarm.core.types import FloatArray, GripperReading, Pose
from latentarm.robots.scene.thing import Thing
from latentarm.surroundings import touch
from latentarm.surroundings.catalogue import TOUCH
from latentarm.surroundings.grasp import Grasp
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
            for sighting, source, hold_s in self._inbox.read(now_s):
                self.tracker.saw(sighting, source, hold_s, now_s)
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
