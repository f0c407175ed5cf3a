"""A cup that is reached for, carried to a bowl and poured out: *Reach & Pour* of the paper's fourth study."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np

from latentarm.kinematics.obstacles import Obstacle
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.scene.scene import Scene
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.predicates import Dropped, Spilled
from latentarm.tasks.region import Region, anywhere
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.serving.counter import (
    FLOUR,
    GRAIN_KG,
    GRAIN_RADIUS_M,
    POSTURE_RAD,
    TOP_M,
    bearing_of,
    counter,
    counter_bowl,
    counter_cup,
    filled,
    hand,
)
from latentarm.tasks.serving.cup_steps import pour, take
from latentarm.types import FloatArray

CUP_AT_M: Final[Region] = ((0.53, 0.62), (-0.28, -0.10))
"""Where the cup stands, x and y."""

BOWL_AT_M: Final[Region] = ((0.54, 0.60), (0.12, 0.24))
"""Where the bowl stands."""

START_M: Final = (0.45, 0.0, 0.50)
"""About where the hand starts."""

START_SPREAD_M: Final = 0.03

GRAINS: Final = 24

POURED: Final = 0.8
"""Share of the grains that must end in the bowl."""

SPILLED: Final = 0.25
"""Share that may be spilled."""


@final
@dataclass(frozen=True, eq=False)
class ReachAndPour(SceneTask):
    """Take a cup, carry it over a bowl, and pour it out.

    Attributes:
        cup_at_m: where the cup may stand, x and y, m.
        bowl_at_m: where the bowl may stand.
    """

    cup_at_m: Region = CUP_AT_M
    bowl_at_m: Region = BOWL_AT_M

    @property
    def name(self) -> str:
        """``reach_and_pour``."""
        return "reach_and_pour"

    @property
    def robot(self) -> Robot:
        """A Panda with its hand."""
        return self._robot

    @property
    def choices(self) -> tuple[str, ...]:
        """One cup."""
        return ("cup",)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """The table; the counter and what stands on it may be touched."""
        return (Scene().table,)

    @property
    def time_limit_s(self) -> float:
        """Two minutes."""
        return 120.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Cup and bowl anywhere in their regions of the counter."""
        cup = counter_cup("cup", *anywhere(self.cup_at_m, rng), colour=(0.36, 0.55, 0.75, 1.0))
        bowl = counter_bowl("bowl", *anywhere(self.bowl_at_m, rng))
        room = bowl.room
        grains = filled("grains", cup, GRAINS, GRAIN_RADIUS_M, GRAIN_KG, FLOUR)
        return Beginning(
            state=start(self.robot, rng),
            scene=Scene((counter(), cup, bowl), (grains,)),
            steps=(*take("cup"), *pour("cup", "grains", "bowl", room, POURED, side=1.0)),
            failures=(
                Dropped("cup", TOP_M - 0.05),
                Spilled("grains", TOP_M - 0.02, (("bowl", room),), SPILLED),
            ),
            goals=(),
            objects=("cup", "bowl"),
            text="pour the cup into the bowl",
        )

    @cached_property
    def _robot(self) -> Robot:
        return load_robot("panda")


def start(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """Where the arm starts over the counter, (n,), rad."""
    place = np.array(START_M) + rng.uniform(-START_SPREAD_M, START_SPREAD_M, 3)
    return solve(robot, hand(place, bearing_of(place)), np.array(POSTURE_RAD))
