"""Where the things are that a decoder looks at."""

from collections.abc import Callable, Mapping, Sequence

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.tasks.place import Place


def surroundings_of(place: Place, objects: Sequence[str]) -> Callable[[], FloatArray] | None:
    """What tells `Step` the poses (K, 9) of things where nothing moves: the goals of a place.

    Args:
        place: its goals are the things.
        objects: names of those that a controller uses; if empty, the result is None.

    Raises:
        UserError: an object is not among the place's goals.
    """
    if not objects:
        return None
    rows = object_rows({goal.name: goal.pose for goal in place.goals}, objects)
    rows.flags.writeable = False
    return lambda: rows


def watched(
    poses: Callable[[], Mapping[str, Pose]], objects: Sequence[str]
) -> Callable[[], FloatArray] | None:
    """What tells `Step` the poses (K, 9) of things that may move.

    Args:
        poses: where things are now, by name.
        objects: names of those that a controller uses; if empty, the result is None.

    Raises:
        UserError: there is no thing of a name.
    """
    if not objects:
        return None
    object_rows(poses(), objects)  # fails now rather than in the loop
    return lambda: object_rows(poses(), objects)
