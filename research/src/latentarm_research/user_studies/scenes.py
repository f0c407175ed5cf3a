"""The tasks that studies are driven at, by name, and such a task with less time."""

from typing import Final, final

import numpy as np

from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot
from latentarm.tasks.catalogue import make_scene_task
from latentarm.tasks.scene_task import Beginning, SceneTask

OVER_MARSHMALLOW: Final = "over_marshmallow"  # HARMONIC's: done once the fork is over the chosen marshmallow


def scene_of(
    name: str,  # `OVER_MARSHMALLOW`, or a name of `latentarm.tasks.catalogue.SCENE_TASKS`
) -> SceneTask:
    """A task. Raises a `UserError` where there is no such task, or it does not load."""
    if name != OVER_MARSHMALLOW:
        return make_scene_task(name)
    from latentarm_research.tasks.over_marshmallow import OverMarshmallow

    return OverMarshmallow()


@final
class AdaptedTask(SceneTask):
    """Another task, whose time limit may be shorter."""

    def __init__(
        self,
        task: SceneTask,
        time_limit_s: float,  # a run that takes longer has failed, s
    ) -> None:
        self._task = task
        self._time_limit_s = min(time_limit_s, task.time_limit_s)

    @property
    def name(self) -> str:
        """That of the task."""
        return self._task.name

    @property
    def robot(self) -> Robot:
        """That of the task."""
        return self._task.robot

    @property
    def choices(self) -> tuple[str, ...]:
        """Those of the task."""
        return self._task.choices

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """Those of the task."""
        return self._task.obstacles

    @property
    def time_limit_s(self) -> float:
        """The shorter of the two."""
        return self._time_limit_s

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """One run of the task."""
        return self._task.begin(choice, rng)
