"""The tasks that studies are driven at, by name."""

from typing import Final

from latentarm.tasks.catalogue import make_scene_task
from latentarm.tasks.scene_task import SceneTask

OVER_MARSHMALLOW: Final = "over_marshmallow"  # HARMONIC's: done once the fork is over the chosen marshmallow


def scene_of(
    name: str,  # `OVER_MARSHMALLOW`, or a name of `latentarm.tasks.catalogue.SCENE_TASKS`
) -> SceneTask:
    """A task. Raises a `UserError` where there is no such task, or it does not load."""
    if name != OVER_MARSHMALLOW:
        return make_scene_task(name)
    from latentarm_research.tasks.over_marshmallow import OverMarshmallow

    return OverMarshmallow()
