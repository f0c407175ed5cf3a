"""Tasks with things that are held, stabbed, cut and poured; they are done in physics."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray, Goal, GripperAsk
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene
from latentarm.tasks.steps import Failure, TaskStep


@final
@dataclass(frozen=True, eq=False)
class Beginning:
    """How one run of a task begins, and what is to be done in it.

    Attributes:
        state: (n,), where the arm starts, rad.
        scene: what stands about it.
        steps: what is to be done, in order.
        failures: what ends the run.
        goals: what the person may want first, for a belief; empty where that is no discrete choice.
        objects: names of the things that matter, in the order of the context feature ``objects``.
        text: what is done, in words.
        asks: what is asked of the gripper all along: at the start, and once each of the steps is done; ()
            where only waypoints ask something.
        patient: whether the run goes on where the tool comes no nearer; else that ends it after a while.
    """

    state: FloatArray
    scene: Scene
    steps: tuple[TaskStep, ...]
    failures: tuple[Failure, ...]
    goals: tuple[Goal, ...]
    objects: tuple[str, ...]
    text: str
    asks: tuple[GripperAsk, ...] = ()
    patient: bool = False


class SceneTask(ABC):
    """Something to be done with things, in steps."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Short name, in snake_case."""

    @property
    @abstractmethod
    def robot(self) -> Robot:
        """The arm, with what it carries."""

    @property
    @abstractmethod
    def choices(self) -> tuple[str, ...]:
        """What a person may choose to do; at least one."""

    @property
    @abstractmethod
    def obstacles(self) -> tuple[Obstacle, ...]:
        """What the arm must keep clear of."""

    @property
    @abstractmethod
    def time_limit_s(self) -> float:
        """A run that takes longer has failed, s."""

    @abstractmethod
    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Draw one run: where things and the arm are.

        Args:
            choice: index into `choices`.
            rng: source of all variation.
        """
