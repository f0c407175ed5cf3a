"""Places: a robot with goals and obstacles, whatever the task."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, final

from latentarm.core.types import Goal
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot


class Place(Protocol):
    """A robot, its goals and its obstacles. Every `Task` is one."""

    @property
    def robot(self) -> Robot:
        """The arm."""
        ...

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The discrete goals ``G``."""
        ...

    @property
    def obstacles(self) -> Sequence[Obstacle]:
        """Shapes that the arm must keep clear of."""
        ...


@final
@dataclass(frozen=True, eq=False)
class ScenePlace:
    """The place of one run of a `SceneTask`; ``objects`` as in `Beginning`."""

    robot: Robot
    goals: tuple[Goal, ...]
    obstacles: tuple[Obstacle, ...]
    objects: tuple[str, ...] = ()
