"""Reach & Pour: in the plane the hand reaches for a bottle and carries it to the bowl; there it pours."""

from typing import Final, final

import numpy as np

from latentarm.tasks.pouring.plane import HEIGHT_M, across_table, at_height
from latentarm.tasks.pouring.pour import BOWL_M, FASTEST, HIGHEST, LOWEST, over
from latentarm.tasks.pouring.pour import DURATION_S as POUR_S
from latentarm.tasks.pouring.task import PouringTask
from latentarm.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, ToolPath, wander_from
from latentarm.types import BoolArray, FloatArray

AT_BOWL_M: Final = 0.05
"""Nearer than this to the bowl's middle, in x and y, the hand is at the bowl, and pours."""

REACH_S: Final = 3.0
"""How long the way to the bottle takes; the bottle stands where it ends."""

PAUSE_S: Final = 0.5
"""Rest between carrying and pouring."""

CARRY_SPEEDS_M_S: Final = (0.5 * SPEED_M_S, SPEED_M_S)
"""Slowest and fastest way to the bowl."""


def at_bowl(position: FloatArray) -> BoolArray:
    """Whether places (..., 3) of the hand, m, are at the bowl (...)."""
    return np.linalg.norm(position[..., :2] - np.array(BOWL_M), axis=-1) < AT_BOWL_M


@final
class ReachAndPour(PouringTask):
    """Plane until the hand is at the bowl, then Pour."""

    @property
    def name(self) -> str:
        """``reach_and_pour``."""
        return "reach_and_pour"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """3 s to the bottle, straight to the bowl, a short rest, 6 s of pouring."""
        reach = across_table(REACH_S, rng)
        carry = at_height(_way_to_bowl(reach.position[-1, :2], rng))
        place = carry.position[-1, :2]
        rest = np.repeat([[HEIGHT_M, 0.0]], round(PAUSE_S * RATE_HZ), axis=0)
        course = wander_from(rest[-1], POUR_S, np.array(LOWEST), np.array(HIGHEST), np.array(FASTEST), rng)
        pour = over(place, np.concatenate([rest, course[1:]]))
        return reach.then(carry.position, carry.tilt).then(pour.position, pour.tilt)


def _way_to_bowl(bottle: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Places (K, 2) straight towards the bowl, all but the last of them outside of it, m."""
    towards = np.array(BOWL_M) - bottle
    distance = float(np.linalg.norm(towards))
    step = rng.uniform(*CARRY_SPEEDS_M_S) / RATE_HZ
    # Half a step to either side of the edge, so that no rounding decides where the hand is at the bowl.
    gone = np.arange(distance - AT_BOWL_M + step / 2, 0.0, -step)[::-1]
    return bottle + gone[:, None] * towards / distance
