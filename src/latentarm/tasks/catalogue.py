"""Tasks for driving, by name: ours, and those that other distributions register."""

from typing import Final

from latentarm.core.plugins import Catalogue
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.task import Task


def _task(name: str, thing: object) -> type[Task]:
    if not (isinstance(thing, type) and issubclass(thing, Task)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.tasks.task.Task")
    return thing


TASKS: Final = Catalogue(
    "latentarm.tasks",
    "task",
    {"table_top": "latentarm.tasks.table_top:TableTop", "reach": "latentarm.tasks.reach:Reach"},
    _task,
)
"""Each is made with a robot where it is for `Task.any_robot`, and without arguments otherwise."""


def _scene_task(name: str, thing: object) -> type[SceneTask]:
    if not (isinstance(thing, type) and issubclass(thing, SceneTask)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.tasks.scene_task.SceneTask")
    return thing


SCENE_TASKS: Final = Catalogue(
    "latentarm.scene_tasks",
    "task",
    {
        "marshmallows": "latentarm.tasks.eating.marshmallows:Marshmallows",
        "entree": "latentarm.tasks.eating.entree:Entree",
        "dessert": "latentarm.tasks.eating.dessert:Dessert",
        "avoid": "latentarm.tasks.serving.avoid:Avoid",
        "pour": "latentarm.tasks.serving.pour:Pour",
        "reach_and_pour": "latentarm.tasks.serving.reach_and_pour:ReachAndPour",
        "apple_pie": "latentarm.tasks.serving.apple_pie:ApplePie",
    },
    _scene_task,
)
"""Tasks with things, which are done in physics; each is made without arguments."""


def make_scene_task(name: str) -> SceneTask:
    """The task of that name in `SCENE_TASKS`."""
    return SCENE_TASKS.find(name, "--task")()


HELD_OUT: Final = "held_out"  # `Replay` of a run's held-out episodes: only a run can make this task
