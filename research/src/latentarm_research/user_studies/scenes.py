"""The tasks that studies are driven at, by name."""

from typing import Final

from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.scene_task import SceneTask

OVER_MARSHMALLOW: Final = "over_marshmallow"  # HARMONIC's: done once the fork is over the chosen marshmallow


def scene_names() -> tuple[str, ...]:
    """Names of all tasks, also of those that other distributions register."""
    return (OVER_MARSHMALLOW, *SCENE_TASKS)


def scene_of(
    name: str,  # of `scene_names`
) -> SceneTask:
    """A task. Raises a `UserError` where there is no such task, or it does not load."""
    if name != OVER_MARSHMALLOW:
        return make_scene_task(name)
    from latentarm_research.tasks.over_marshmallow import OverMarshmallow

    return OverMarshmallow()
