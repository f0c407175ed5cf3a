"""The tasks that an arm can be driven at, by name: ours, and those that other distributions register."""

from typing import Final

from latentarm.plugins import Catalogue
from latentarm.tasks.task import Task


def _task(name: str, thing: object) -> type[Task]:
    if not (isinstance(thing, type) and issubclass(thing, Task)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.tasks.task.Task")
    return thing


TASKS: Final = Catalogue(
    "latentarm.tasks",
    "task",
    {
        "table_top": "latentarm.tasks.table_top:TableTop",
        "reach": "latentarm.tasks.reach:Reach",
        "planar_two_cups": "latentarm.tasks.two_cups:PlanarTwoCups",
        "panda_two_cups": "latentarm.tasks.two_cups:PandaTwoCups",
    },
    _task,
)
"""Each is made with a robot where it is for `Task.any_robot`, and without arguments otherwise."""

HELD_OUT: Final = "held_out"
"""Following the held-out episodes of a run, `Replay`: a task that only a run can make."""
