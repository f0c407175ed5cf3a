"""The tasks with things, by name. Nothing is imported before one is made."""

from collections.abc import Mapping
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Final

from latentarm.errors import UserError

if TYPE_CHECKING:
    from latentarm.tasks.scene_task import SceneTask

SCENE_TASKS: Final[Mapping[str, str]] = {
    "marshmallows": "latentarm.tasks.eating.marshmallows:Marshmallows",
    "entree": "latentarm.tasks.eating.entree:Entree",
    "dessert": "latentarm.tasks.eating.dessert:Dessert",
    "avoid": "latentarm.tasks.serving.avoid:Avoid",
    "pour": "latentarm.tasks.serving.pour:Pour",
    "reach_and_pour": "latentarm.tasks.serving.reach_and_pour:ReachAndPour",
    "apple_pie": "latentarm.tasks.serving.apple_pie:ApplePie",
}
"""The class of each, made without arguments."""


def make_scene_task(name: str) -> "SceneTask":
    """A task with things.

    Args:
        name: a name in `SCENE_TASKS`.

    Raises:
        UserError: there is no such task.
    """
    if name not in SCENE_TASKS:
        raise UserError(f"There is no task with things named {name!r}: choose from {', '.join(SCENE_TASKS)}.")
    return resolve_name(SCENE_TASKS[name])()
