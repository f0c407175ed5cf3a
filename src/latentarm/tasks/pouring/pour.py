"""Pour: over a bowl the hand moves up and down, and tilts."""

from typing import Final, final

import numpy as np

from latentarm.tasks.pouring.task import PouringTask
from latentarm.tasks.pouring.tool_path import SPEED_M_S, TURN_RAD_S, ToolPath, wander
from latentarm.types import FloatArray

BOWL_M: Final = (0.5, 0.25)
"""x and y of the bowl's middle; it stands to the left of the table."""

SPREAD_M: Final = 0.02
"""SD of where the hand is over the bowl, along x and along y."""

DURATION_S: Final = 6.0
LOWEST: Final = (0.2, -0.9)
"""Height, m, and tilt, rad, of the hand, at least."""

HIGHEST: Final = (0.45, 0.9)
"""The same, at most."""

FASTEST: Final = (SPEED_M_S, TURN_RAD_S)


def over(place: FloatArray, course: FloatArray) -> ToolPath:
    """Heights and tilts (T, 2) over one place (2,), m."""
    position = np.concatenate([np.broadcast_to(place, (len(course), 2)), course[:, :1]], axis=1)
    return ToolPath(position, course[:, 1])


@final
class Pour(PouringTask):
    """Up, down and tilted over a bowl."""

    @property
    def name(self) -> str:
        """``pour``."""
        return "pour"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """6 s over one place."""
        place = BOWL_M + rng.normal(0.0, SPREAD_M, 2)
        return over(place, wander(DURATION_S, np.array(LOWEST), np.array(HIGHEST), np.array(FASTEST), rng))
