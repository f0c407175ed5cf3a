"""The base of tasks at the counter: a Panda with its hand, its start, and failures."""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.robots.scene.thing import Thing
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.predicates import Dropped, Spilled
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.serving.counter import POSTURE_RAD, TOP_M, bearing_of, hand

START_M: Final = (0.45, 0.0, 0.50)  # about the hand's start
START_SPREAD_M: Final = 0.03
SPILLED: Final = 0.25  # largest share of spilled grains


class CounterTask(SceneTask):
    """A task for the hand, at a counter."""

    @property
    @final
    def robot(self) -> Robot:
        return load_robot("panda")

    @final
    def reaching(self, place: FloatArray) -> FloatArray:
        """Joints (n,), rad, that put the fingertips at a place (3,), m, pointing away from the base."""
        return solve(self.robot, hand(place, bearing_of(place)), np.array(POSTURE_RAD))

    @final
    def start(self, rng: np.random.Generator) -> FloatArray:
        """A start over the counter, (n,), rad."""
        return self.reaching(np.array(START_M) + rng.uniform(-START_SPREAD_M, START_SPREAD_M, 3))


def fallen(*names: str) -> tuple[Dropped, ...]:
    """Failures when a thing falls off the counter."""
    return tuple(Dropped(name, TOP_M - 0.05) for name in names)


def spilled(grains: str, *bowls: Thing) -> Spilled:
    """The failure when grains lie on the counter rather than in the bowls."""
    return Spilled(grains, TOP_M - 0.02, tuple((bowl.name, bowl.room) for bowl in bowls), SPILLED)
