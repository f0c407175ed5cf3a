"""Three marshmallows on a plate, one of which is to be stabbed: the paper's first user study, in physics."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.scene.scene import Scene
from latentarm.tasks.eating.fork_task import ForkTask, fallen
from latentarm.tasks.eating.stabbing import above, stab
from latentarm.tasks.eating.table import marshmallow, plate
from latentarm.tasks.scene_task import Beginning, Region, anywhere

PLATE_AT_M: Final[Region] = ((0.5, 0.5), (0.0, 0.0))
"""x and y of the plate's middle: always the same, as in the paper."""

NAMES: Final = ("left marshmallow", "middle marshmallow", "right marshmallow")
BEARINGS_RAD: Final = (np.pi / 2, 0.0, -np.pi / 2)  # of the sectors from the plate's middle
SECTOR_RAD: Final = 0.6  # half the width of a sector
OUT_M: Final = (0.045, 0.075)  # distance from the plate's middle


@final
@dataclass(frozen=True, eq=False)
class Marshmallows(ForkTask):
    """Bring the fork over the chosen marshmallow, stab it and lift it."""

    name = "marshmallows"
    choices = NAMES
    time_limit_s = 60.0
    plate_at_m: Region = PLATE_AT_M  # region of the plate's middle, x and y, m

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Marshmallows at random in their sectors, the arm about its home."""
        middle = anywhere(self.plate_at_m, rng)
        places = [_place(middle, index, rng) for index in range(len(NAMES))]
        food = [
            marshmallow(name, x, y, rng.uniform(-np.pi, np.pi))
            for name, (x, y) in zip(NAMES, places, strict=True)
        ]
        scene = Scene((plate("plate", *middle), *food))
        wanted = NAMES[choice]
        return Beginning(
            state=self.start(rng),
            scene=scene,
            steps=(above(wanted), stab(wanted)),
            failures=fallen(*NAMES),
            goals=self.goals(food),
            objects=NAMES,
            text=f"stab the {wanted}",
        )


def _place(plate: FloatArray, index: int, rng: np.random.Generator) -> tuple[float, float]:
    bearing = BEARINGS_RAD[index] + rng.uniform(-SECTOR_RAD, SECTOR_RAD)
    out = rng.uniform(*OUT_M)
    return float(plate[0] + out * np.cos(bearing)), float(plate[1] + out * np.sin(bearing))
