"""Places: a robot with goals and obstacles, whatever the task; and the poses of the things there."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from latentarm.core.types import FloatArray, Goal, Pose
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene


@final
@dataclass(frozen=True, eq=False)
class Place:
    """The place of one run of a task."""

    robot: Robot
    goals: tuple[Goal, ...]
    obstacles: tuple[Obstacle, ...]  # shapes that the arm must keep clear of
    objects: tuple[str, ...] = ()  # as in `Beginning`
    shown: Scene | None = None  # things about the arm for display only


def surroundings_of(goals: Sequence[Goal], objects: Sequence[str]) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of goals as things that never move; None without objects."""
    poses = {goal.name: goal.pose for goal in goals}
    return watched(lambda: poses, objects)


def watched(
    poses: Callable[[], Mapping[str, Pose]], objects: Sequence[str]
) -> Callable[[], FloatArray] | None:
    """A source of the poses (K, 9) of things that may move; None without objects."""
    if not objects:
        return None
    object_rows(poses(), objects)  # fails now rather than in the loop
    return lambda: object_rows(poses(), objects)
