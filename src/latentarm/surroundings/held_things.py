"""Which things count as held, for the safety filters and for people."""

from collections.abc import Iterable, Mapping, Sequence
from typing import final

from latentarm.core.types import GripperReading, Pose
from latentarm.robots.held import Held
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.scene.thing import Thing
from latentarm.surroundings.grasp import bounds


@final
class HeldThings:
    """Follows which things are held, and where they lay in the tool when they were taken.

    Args:
        things: of known size.
        stated: by a person: what is mounted counts always; the others stand for what the gripper holds as
            long as no known thing does.
    """

    def __init__(self, things: Iterable[Thing], stated: Sequence[Held]) -> None:
        self._things = {thing.name: thing for thing in things}
        self._mounted = tuple(one for one in stated if one.mounted)
        self._gripped = tuple(one for one in stated if not one.mounted)
        self._carried: dict[str, Held] = {}
        self.now: tuple[Held, ...] = ()
        self._holding = False

    def update(self, carried: Mapping[str, Pose], gripper: GripperReading | None) -> bool:
        """Take what moves with the tool, by poses in its frame, and the gripper; whether others count now.

        What the gripper holds may lose contact for a moment: it stays until the gripper holds nothing.
        """
        if gripper is not None:
            self._holding = gripper.holding
        holding = self._holding
        known = {name: pose for name, pose in carried.items() if name in self._things}
        if not holding:
            self._carried = {name: one for name, one in self._carried.items() if name in known}
        for name in known.keys() - self._carried.keys():
            self._carried[name] = _held(self._things[name], known[name])
        assumed = self._gripped if holding and not self._carried else ()
        now = (*self._mounted, *self._carried.values(), *assumed)
        changed = now != self.now
        self.now = now
        return changed


def _held(thing: Thing, pose: Pose) -> Held:
    lower, upper = bounds(thing.parts)
    middle = pose.position + pose.rotation @ (0.5 * (lower + upper))
    return Held(Box(thing.name, middle, pose.rotation, 0.5 * (upper - lower)), thing.mass_kg)
