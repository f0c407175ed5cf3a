"""Plane: the hand moves in the x-y plane."""

from typing import Final, final

import numpy as np

from latentarm.tasks.pouring.task import PouringTask
from latentarm.tasks.pouring.tool_path import SPEED_M_S, ToolPath, wander
from latentarm.types import FloatArray

DURATION_S: Final = 6.0
HEIGHT_M: Final = 0.3
"""Of the plane above the base."""

NEAR_RIGHT_M: Final = (0.33, -0.35)
"""x and y of the corner of the table nearest to the base, on the right."""

FAR_LEFT_M: Final = (0.65, 0.15)
"""x and y of the opposite corner."""


def across_table(seconds: float, rng: np.random.Generator) -> ToolPath:
    """A smooth random course in the plane over the table."""
    place = wander(seconds, np.array(NEAR_RIGHT_M), np.array(FAR_LEFT_M), np.full(2, SPEED_M_S), rng)
    return at_height(place)


def at_height(place: FloatArray) -> ToolPath:
    """Places (T, 2) in the plane, m, as a path of an upright hand."""
    height = np.full((len(place), 1), HEIGHT_M)
    return ToolPath(np.concatenate([place, height], axis=1), np.zeros(len(place)))


@final
class Plane(PouringTask):
    """Anywhere over the table, at one height."""

    @property
    def name(self) -> str:
        """``plane``."""
        return "plane"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """6 s over the table."""
        return across_table(DURATION_S, rng)
