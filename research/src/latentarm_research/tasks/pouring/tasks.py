"""The tasks of section 8.3.

Plane: the hand moves in the x-y plane. Pour: over a bowl it moves up and down, and tilts. Reach & Pour: in
the plane it reaches for a bottle and carries it to the bowl, where it pours.
"""

from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm_research.tasks.pouring.task import PouringTask
from latentarm_research.tasks.pouring.tool_path import (
    RATE_HZ,
    SPEED_M_S,
    TURN_RAD_S,
    ToolPath,
    wander,
    wander_from,
)

DURATION_S: Final = 6.0
"""Of Plane, and of pouring."""

HEIGHT_M: Final = 0.3
"""Of the plane above the base."""

NEAR_RIGHT_M: Final = (0.33, -0.35)
"""x and y of the corner of the table nearest to the base, on the right."""

FAR_LEFT_M: Final = (0.65, 0.15)
"""x and y of the opposite corner."""

BOWL_M: Final = (0.5, 0.25)
"""x and y of the bowl's middle; it stands to the left of the table."""

SPREAD_M: Final = 0.02
"""SD of where the hand is over the bowl, along x and along y."""

LOWEST: Final = (0.2, -0.9)
"""Height, m, and tilt, rad, of the hand, at least."""

HIGHEST: Final = (0.45, 0.9)
"""The same, at most."""

FASTEST: Final = (SPEED_M_S, TURN_RAD_S)

AT_BOWL_M: Final = 0.05
"""Nearer than this to the bowl's middle, in x and y, the hand is at the bowl, and pours."""

REACH_S: Final = 3.0
"""How long the way to the bottle takes; the bottle stands where it ends."""

PAUSE_S: Final = 0.5
"""Rest between carrying and pouring."""

CARRY_SPEEDS_M_S: Final = (0.5 * SPEED_M_S, SPEED_M_S)
"""Slowest and fastest way to the bowl."""


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

    name = "plane"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """6 s over the table."""
        return across_table(DURATION_S, rng)


def over(place: FloatArray, course: FloatArray) -> ToolPath:
    """Heights and tilts (T, 2) over one place (2,), m."""
    position = np.concatenate([np.broadcast_to(place, (len(course), 2)), course[:, :1]], axis=1)
    return ToolPath(position, course[:, 1])


@final
class Pour(PouringTask):
    """Up, down and tilted over a bowl."""

    name = "pour"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """6 s over one place."""
        place = BOWL_M + rng.normal(0.0, SPREAD_M, 2)
        return over(place, wander(DURATION_S, np.array(LOWEST), np.array(HIGHEST), np.array(FASTEST), rng))


def at_bowl(position: FloatArray) -> BoolArray:
    """Whether places (..., 3) of the hand, m, are at the bowl (...)."""
    return np.linalg.norm(position[..., :2] - np.array(BOWL_M), axis=-1) < AT_BOWL_M


@final
class ReachAndPour(PouringTask):
    """Plane until the hand is at the bowl, then Pour."""

    name = "reach_and_pour"

    def draw(self, rng: np.random.Generator) -> ToolPath:
        """3 s to the bottle, straight to the bowl, a short rest, 6 s of pouring."""
        reach = across_table(REACH_S, rng)
        carry = at_height(_way_to_bowl(reach.position[-1, :2], rng))
        place = carry.position[-1, :2]
        rest = np.repeat([[HEIGHT_M, 0.0]], round(PAUSE_S * RATE_HZ), axis=0)
        course = wander_from(
            rest[-1], DURATION_S, np.array(LOWEST), np.array(HIGHEST), np.array(FASTEST), rng
        )
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


POURING_TASKS: Final[dict[str, Callable[[], PouringTask]]] = {
    "plane": Plane,
    "pour": Pour,
    "reach_and_pour": ReachAndPour,
}
