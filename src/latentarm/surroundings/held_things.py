"""Which things count as held, for the safety filters and for people."""

from collections.abc import Iterable, Mapping
from typing import final

from latentarm.core.types import GripperReading, Pose
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.scene.thing import Thing
from latentarm.surroundings.grasp import bounds


@final
class HeldThings:
    """Follows which things are held, as boxes where they lay in the tool's frame when they were taken.

    Args:
        things: of known size.
        assumed: what the gripper holds while no known thing is held.
    """

    def __init__(self, things: Iterable[Thing], assumed: tuple[Box, ...]) -> None:
        self._bounds = {thing.name: bounds(thing.parts) for thing in things}
        self._assumed = assumed
        self._carried: dict[str, Box] = {}
        self._holding = False
        self.now: tuple[Box, ...] = ()

    def update(self, carried: Mapping[str, Pose], gripper: GripperReading | None) -> bool:
        """Take what moves with the tool, by poses in its frame, and the gripper; whether others count now.

        What the gripper holds may lose contact for a moment: it stays until the gripper holds nothing.
        """
        if gripper is not None:
            self._holding = gripper.holding
        known = {name: pose for name, pose in carried.items() if name in self._bounds}
        kept = {name: box for name, box in self._carried.items() if self._holding or name in known}
        self._carried = {name: self._box(name, pose) for name, pose in known.items()} | kept
        before = self.now
        self.now = tuple(self._carried.values()) or (self._assumed if self._holding else ())
        return {box.name for box in before} != {box.name for box in self.now}

    def _box(self, name: str, pose: Pose) -> Box:
        lower, upper = self._bounds[name]
        middle = pose.position + pose.rotation @ (0.5 * (lower + upper))
        return Box(name, middle, pose.rotation, 0.5 * (upper - lower))
