"""A cup that is shared between two bowls: *Pour* of the paper's fourth user study, in physics."""

from typing import Final, final

import numpy as np

from latentarm.robots.scene.scene import Scene
from latentarm.tasks.scene_task import Beginning, Region, anywhere
from latentarm.tasks.serving.counter import FLOUR, GRAIN_KG, counter, counter_bowl, counter_cup, filled
from latentarm.tasks.serving.counter_task import CounterTask, fallen, spilled
from latentarm.tasks.serving.cup_steps import pour, take

CUP_AT_M: Final[Region] = ((0.54, 0.58), (-0.02, 0.02))  # the cup, x and y
LEFT_AT_M: Final[Region] = ((0.54, 0.58), (0.20, 0.24))  # the left bowl
RIGHT_AT_M: Final[Region] = ((0.54, 0.58), (-0.24, -0.20))  # the right bowl
GRAINS: Final = 36
GRAIN_M: Final = 0.0049
SIZES: Final = (1.0, 0.96, 0.92, 0.88, 0.84)  # radii of the grains, as shares of `GRAIN_M`, the largest
FLOOR_M: Final = 0.059
"""Thickness of the cup's floor: the cup is shallow and full, so that grains begin to leave it at a tilt of
about 60 degrees, and more of them the farther it is tilted."""

SHARE: Final = 0.2  # of the grains that must end in each bowl
TIP_SPEED: Final = 0.12  # of tipping, as a share of the person's usual speed: some must stay in the cup


@final
class Pour(CounterTask):
    """Take a cup, pour some of it into the left bowl and some into the right one."""

    name = "pour"
    choices = ("cup",)
    time_limit_s = 120.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Cup and bowls at random in their regions of the counter."""
        cup = counter_cup("cup", *anywhere(CUP_AT_M, rng), floor_m=FLOOR_M)
        left = counter_bowl("left bowl", *anywhere(LEFT_AT_M, rng))
        right = counter_bowl("right bowl", *anywhere(RIGHT_AT_M, rng))
        grains = filled("grains", cup, GRAINS, GRAIN_M, GRAIN_KG, FLOUR, SIZES)
        return Beginning(
            state=self.start(rng),
            scene=Scene((counter(), cup, left, right), (grains,)),
            steps=(
                *take("cup"),
                *pour("cup", "grains", "left bowl", left.room, SHARE, side=1.0, tip_speed=TIP_SPEED),
                *pour(
                    "cup", "grains", "right bowl", right.room, SHARE, side=-1.0, leaving=("left bowl", 1.0)
                ),
            ),
            failures=(*fallen("cup"), spilled("grains", left, right)),
            goals=(),
            objects=("cup", "left bowl", "right bowl"),
            text="share the cup between the bowls",
        )
