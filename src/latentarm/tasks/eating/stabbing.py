"""The steps that tasks with a fork have in common: over the food, into it, and up again."""

from functools import partial
from typing import Final

from latentarm.scene.scene import SceneState
from latentarm.tasks.eating.table import MARSHMALLOW_HALF_M, STAND_M, fork
from latentarm.tasks.predicates import Above, Stabbed
from latentarm.tasks.steps import TaskStep, Waypoint
from latentarm.types import Pose

HOVER_M: Final = 0.10
"""How far over the middle of the food a reach ends."""

INTO_M: Final = 0.004
"""How far below its middle the tip is meant to go."""

LIFTED_M: Final = 0.04
"""How far food must have left its plate."""


def above(thing: str, turn_rad: float | None = None) -> TaskStep:
    """Bring the fork over food.

    Args:
        thing: its name.
        turn_rad: see `latentarm.tasks.eating.table.fork`.
    """
    over = Waypoint(partial(_over, thing=thing, height_m=HOVER_M, turn_rad=turn_rad))
    return TaskStep("above", f"above the {thing}", Above(thing, 0.02, 0.05, 0.2), (over,))


def stab(thing: str, turn_rad: float | None = None, half_m: float = MARSHMALLOW_HALF_M) -> TaskStep:
    """Go straight down into food, and lift it.

    Args:
        thing: its name.
        turn_rad: see `latentarm.tasks.eating.table.fork`.
        half_m: half of its height, m.
    """
    over = partial(_over, thing=thing, turn_rad=turn_rad)
    lying_m = STAND_M + half_m
    near = Waypoint(partial(over, height_m=half_m + 0.02), within_m=0.008, speed=0.6)
    into = Waypoint(partial(over, height_m=-INTO_M), within_m=0.008, wait_s=0.1, speed=0.4)
    lifted = Waypoint(partial(_over_plate, thing=thing, height_m=lying_m + HOVER_M, turn_rad=turn_rad))
    done = Stabbed(thing, lying_m + LIFTED_M)
    return TaskStep("stabbed", f"the {thing} on the fork", done, (near, into, lifted))


def _over(state: SceneState, thing: str, height_m: float, turn_rad: float | None) -> Pose:
    """The fork upright over a thing."""
    return fork(state.poses[thing].position, height_m, turn_rad)


def _over_plate(state: SceneState, thing: str, height_m: float, turn_rad: float | None) -> Pose:
    """The same, at a height in the base frame of the arm, wherever the thing is."""
    place = state.poses[thing].position.copy()
    place[2] = 0.0
    return fork(place, height_m, turn_rad)
