"""Tasks with things to hold, stab, cut and pour, in physics."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray, Goal, GripperAsk
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene
from latentarm.tasks.steps import Failure, TaskStep

Region = tuple[tuple[float, float], tuple[float, float]]  # lowest and highest x, lowest and highest y, m


def anywhere(region: Region, rng: np.random.Generator) -> FloatArray:
    """A place in a region, uniformly at random, (2,), m."""
    lower, upper = np.array(region).T
    return rng.uniform(lower, upper)


@final
@dataclass(frozen=True, eq=False)
class Beginning:
    """The start of one run of a task, and its steps."""

    state: FloatArray  # (n,), start of the arm, rad
    scene: Scene
    steps: tuple[TaskStep, ...]  # in order
    failures: tuple[Failure, ...]  # each ends the run
    # the person's possible first goals, for a belief; empty where these are no discrete choice
    goals: tuple[Goal, ...]
    objects: tuple[str, ...]  # names of the relevant things, in the order of the context feature ``objects``
    text: str  # the task in words
    # asked of the gripper all along: at the start, and once each step is done; () where only waypoints ask
    asks: tuple[GripperAsk, ...] = ()
    patient: bool = False  # whether the run goes on where the tool comes no nearer


class SceneTask(ABC):
    """A task with things, in steps."""

    name: str  # short, in snake_case
    choices: tuple[str, ...]  # variants that a person may choose from; at least one
    obstacles: tuple[Obstacle, ...] = (Scene().table,)  # shapes that the arm must keep clear of
    time_limit_s: float  # a run that takes longer has failed

    @property
    @abstractmethod
    def robot(self) -> Robot:
        """The arm, with what it carries."""

    @abstractmethod
    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Draw one run of the choice with this index: places of things and start of the arm."""
