"""Poses of the things that a decoder sees."""

from collections.abc import Callable, Mapping, Sequence

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.tasks.place import Place


def surroundings_of(place: Place, objects: Sequence[str]) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of goals as things that never move; None without objects."""
    if not objects:
        return None
    rows = object_rows({goal.name: goal.pose for goal in place.goals}, objects)
    rows.flags.writeable = False
    return lambda: rows


def watched(
    poses: Callable[[], Mapping[str, Pose]], objects: Sequence[str]
) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of things that may move; None without objects."""
    if not objects:
        return None
    object_rows(poses(), objects)  # fails now rather than in the loop
    return lambda: object_rows(poses(), objects)
