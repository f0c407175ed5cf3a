"""A cup that is reached for, carried to a bowl and poured out: *Reach & Pour* of the paper's fourth study."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.robots.scene.scene import Scene
from latentarm.tasks.scene_task import Beginning, Region, anywhere
from latentarm.tasks.serving.counter import (
    FLOUR,
    GRAIN_KG,
    GRAIN_RADIUS_M,
    counter,
    counter_bowl,
    counter_cup,
    filled,
)
from latentarm.tasks.serving.counter_task import CounterTask, fallen, spilled
from latentarm.tasks.serving.cup_steps import POURED, pour, take

CUP_AT_M: Final[Region] = ((0.53, 0.62), (-0.28, -0.10))  # the cup, x and y
BOWL_AT_M: Final[Region] = ((0.54, 0.60), (0.12, 0.24))  # the bowl
GRAINS: Final = 24


@final
@dataclass(frozen=True, eq=False)
class ReachAndPour(CounterTask):
    """Take a cup, carry it over a bowl, and pour it out."""

    name = "reach_and_pour"
    choices = ("cup",)
    time_limit_s = 120.0
    cup_at_m: Region = CUP_AT_M  # region of the cup, x and y, m
    bowl_at_m: Region = BOWL_AT_M

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Cup and bowl at random in their regions of the counter."""
        cup = counter_cup("cup", *anywhere(self.cup_at_m, rng))
        bowl = counter_bowl("bowl", *anywhere(self.bowl_at_m, rng))
        grains = filled("grains", cup, GRAINS, GRAIN_RADIUS_M, GRAIN_KG, FLOUR)
        return Beginning(
            state=self.start(rng),
            scene=Scene((counter(), cup, bowl), (grains,)),
            steps=(*take("cup"), *pour("cup", "grains", "bowl", bowl.room, POURED, side=1.0)),
            failures=(*fallen("cup"), spilled("grains", bowl)),
            goals=(),
            objects=("cup", "bowl"),
            text="pour the cup into the bowl",
        )
