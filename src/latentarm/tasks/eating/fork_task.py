"""The base of tasks with a fork: a Panda, its start, and a goal over each thing."""

from collections.abc import Iterable
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Goal
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.robots.scene.thing import Thing
from latentarm.tasks.eating.stabbing import HOVER_M
from latentarm.tasks.eating.table import STAND_M, fork
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.predicates import Dropped
from latentarm.tasks.scene_task import SceneTask

START_SPREAD_RAD: Final = np.array([0.3, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05])
"""How far each joint may start from the robot's home, at most: mostly turned about the base."""

OFF_M: Final = STAND_M - 0.02  # lower food has fallen off its dish, and lower rice is spilled


class ForkTask(SceneTask):
    """A task with a fork, at a table with dishes on stands."""

    @property
    @final
    def robot(self) -> Robot:
        return load_robot("panda_fork")

    @final
    def start(self, rng: np.random.Generator) -> FloatArray:
        """A start about home, (n,), rad."""
        return self.robot.home + rng.uniform(-START_SPREAD_RAD, START_SPREAD_RAD)

    @final
    def goals(self, things: Iterable[Thing], turn_rad: float | None = None) -> tuple[Goal, ...]:
        """The fork over each thing as it begins; ``turn_rad`` as in `latentarm.tasks.eating.table.fork`."""
        return tuple(self._over(thing, turn_rad) for thing in things)

    def _over(self, thing: Thing, turn_rad: float | None) -> Goal:
        wanted = fork(thing.pose.position, HOVER_M, turn_rad)
        configuration = solve(self.robot, wanted, self.robot.home)
        return Goal(thing.name, configuration, self.robot.chain.forward(configuration))


def fallen(*food: str) -> tuple[Dropped, ...]:
    """Failures when food falls off its dish."""
    return tuple(Dropped(name, OFF_M) for name in food)
