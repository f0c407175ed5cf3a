"""Steps of tasks with a fork: over the food, into it, and up again."""

from functools import partial
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.eating.table import MARSHMALLOW_HALF_M, STAND_M, fork
from latentarm.tasks.predicates import Above, Lifted, Taken
from latentarm.tasks.steps import TaskStep, Waypoint

HOVER_M: Final = 0.10  # height of a reach's end over the middle of the food
INTO_M: Final = 0.004  # target depth of the tip below the food's middle
LIFTED_M: Final = 0.04  # height of lifted food over its plate


def above(thing: str, turn_rad: float | None = None) -> TaskStep:
    """Bring the fork over food; ``turn_rad`` as in `latentarm.tasks.eating.table.fork`."""
    high = Waypoint(partial(over, thing=thing, height_m=HOVER_M, turn_rad=turn_rad))
    return TaskStep("above", thing, f"above the {thing}", Above(thing, 0.02, 0.05, 0.2), (high,))


def stab(thing: str, turn_rad: float | None = None, half_m: float = MARSHMALLOW_HALF_M) -> TaskStep:
    """Go straight down into food of half height ``half_m``, and lift it."""
    above_it = partial(over, thing=thing, turn_rad=turn_rad)
    lying_m = STAND_M + half_m
    near = Waypoint(partial(above_it, height_m=half_m + 0.02), within_m=0.008, speed=0.6)
    into = Waypoint(
        partial(above_it, height_m=-INTO_M), within_m=0.008, wait_s=0.1, speed=0.4, until=Taken(thing)
    )
    lifted = Waypoint(partial(_over_plate, thing=thing, height_m=lying_m + HOVER_M, turn_rad=turn_rad))
    done = Lifted(thing, lying_m + LIFTED_M)
    return TaskStep("stabbed", thing, f"the {thing} on the fork", done, (near, into, lifted))


def over(
    state: SceneState,
    thing: str,
    height_m: float,
    turn_rad: float | None = None,
    tilt_rad: float = 0.0,
    out_m: float = 0.0,
) -> Pose:
    """The fork with its tip ``height_m`` over a thing, shifted away from the base by ``out_m``."""
    place: FloatArray = state.poses[thing].position
    outwards = np.array([place[0], place[1], 0.0]) / np.hypot(place[0], place[1])
    return fork(place + out_m * outwards, height_m, turn_rad, tilt_rad)


def carried_over(
    state: SceneState,
    food: str,
    thing: str,
    height_m: float,
    turn_rad: float | None = None,
    tilt_rad: float = 0.0,
    out_m: float = 0.0,
) -> Pose:
    """The fork that brings food over a thing, corrected for how the food sits on it.

    Until the fork holds the food, it is expected where `stab` takes it. ``height_m`` is that of the tip if
    the food sits as expected; the rest is as in `over`.
    """
    pose = over(state, thing, height_m, turn_rad, tilt_rad, out_m)
    if food not in state.stabbed:
        return pose
    sits = (state.poses[food].position - state.tool.position) @ state.tool.rotation
    away = np.array([0.0, 0.0, -INTO_M]) - sits
    return Pose(pose.position + pose.rotation @ away, pose.rotation)


def _over_plate(state: SceneState, thing: str, height_m: float, turn_rad: float | None) -> Pose:
    """The fork at a height in the arm's base frame, wherever the thing is."""
    place = state.poses[thing].position.copy()
    place[2] = 0.0
    return fork(place, height_m, turn_rad)
