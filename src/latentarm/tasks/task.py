"""The contract of a task, and when a pose counts as reached."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, Goal, Pose
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene


class Task(ABC):
    """A robot with discrete goals, and ways (manners) of doing something at each."""

    # Whether the task takes any robot as its argument; else it takes no arguments and has its own
    any_robot: ClassVar[bool] = False

    name: str
    """Short name, in snake_case."""

    manners: tuple[str, ...]
    """Names of the acts that are possible at a goal, at least one."""

    obstacles: tuple[Obstacle, ...]
    """Shapes that the arm must keep clear of."""

    @property
    @abstractmethod
    def robot(self) -> Robot:
        """The arm."""

    @property
    @abstractmethod
    def goals(self) -> tuple[Goal, ...]:
        """The discrete goals ``G`` that a person may have."""

    @property
    def shown(self) -> Scene:
        """Things about the arm for display only; empty by default."""
        return Scene()

    @abstractmethod
    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """A start on the way to the goal with this index, (n,), rad."""

    @abstractmethod
    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """Poses that the tool must reach in turn for the task to be done, at the goal with this index.

        Raises UserError where there is no such goal or manner.
        """

    @abstractmethod
    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Whether the tool at ``pose`` counts as being at ``waypoint``."""

    @abstractmethod
    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Episodes by a simulated person, spread over goals and manners; UserError for fewer than one."""


def check_not_done(task: Task, start: FloatArray, waypoints: Sequence[Pose]) -> None:
    """Refuse a start (n,), rad, from which nothing is left to do: standing still is no success."""
    pose = task.robot.chain.forward(start)
    if all(task.reached(pose, waypoint) for waypoint in waypoints):
        raise UserError(
            f"The task {task.name} is done before it begins: {task.robot.chain.tools[0].name} of"
            f" {task.robot.name} starts where it is to go. Choose another end-effector or task."
        )


REACHED_DISTANCE = 0.03  # a waypoint is reached within this distance, m, ...
REACHED_ANGLE = np.deg2rad(20.0)  # ... and this angle, rad.


def within(pose: Pose, waypoint: Pose) -> bool:
    """Whether one pose is within `REACHED_DISTANCE` and `REACHED_ANGLE` of another."""
    distance = np.linalg.norm(pose.position - waypoint.position)
    return bool(
        distance <= REACHED_DISTANCE and angle_between(pose.rotation, waypoint.rotation) <= REACHED_ANGLE
    )
