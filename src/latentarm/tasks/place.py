"""Places: a robot with goals and obstacles, whatever the task; and the poses of the things there."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, final

from latentarm.core.types import FloatArray, Goal, Pose
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.kinematics.pose_rows import object_rows
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


def surroundings_of(place: Place, objects: Sequence[str]) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of goals as things that never move; None without objects."""
    if not objects:
        return None
    rows = object_rows({goal.name: goal.pose for goal in place.goals}, objects)
    rows.flags.writeable = False
    return lambda: rows


def watched(
    poses: Callable[[], Mapping[str, Pose]], objects: Sequence[str]
) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of things that may move; None without objects."""
    if not objects:
        return None
    object_rows(poses(), objects)  # fails now rather than in the loop
    return lambda: object_rows(poses(), objects)
