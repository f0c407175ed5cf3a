"""What an arm is driven at, whatever is to be done there."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, final

from latentarm.core.types import Goal
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot


class Place(Protocol):
    """A robot, what its person may want, and what it must keep clear of. Every `Task` is one."""

    @property
    def robot(self) -> Robot:
        """The arm."""
        ...

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The discrete goals ``G`` that a person may have."""
        ...

    @property
    def obstacles(self) -> Sequence[Obstacle]:
        """What the arm must keep clear of."""
        ...


@final
@dataclass(frozen=True, eq=False)
class ScenePlace:
    """Where one run of a `SceneTask` is driven.

    Attributes:
        robot: the arm, with what it carries.
        goals: what the person may want first.
        obstacles: what the arm must keep clear of.
        objects: names of the things that matter, see `Beginning`.
    """

    robot: Robot
    goals: tuple[Goal, ...]
    obstacles: tuple[Obstacle, ...]
    objects: tuple[str, ...] = ()
