"""Where the things are that a decoder looks at."""

from collections.abc import Callable, Sequence

from latentarm.kinematics.pose_rows import object_rows
from latentarm.tasks.task import Task
from latentarm.types import FloatArray


def surroundings_of(task: Task, objects: Sequence[str]) -> Callable[[], FloatArray] | None:
    """What tells `Step` the poses (K, 9) of things at a task without physics, whose goals they are.

    Args:
        task: its goals are the things.
        objects: names of those that a controller looks at; where there are none, nothing is told.

    Raises:
        UserError: a thing is none of the task's goals.
    """
    if not objects:
        return None
    rows = object_rows({goal.name: goal.pose for goal in task.goals}, objects)
    rows.flags.writeable = False
    return lambda: rows
