"""The steps that tasks with a fork have in common: over the food, into it, and up again."""

from functools import partial
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.eating.table import MARSHMALLOW_HALF_M, STAND_M, fork
from latentarm.tasks.predicates import Above, Stabbed, Taken
from latentarm.tasks.steps import TaskStep, Waypoint

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
    high = Waypoint(partial(over, thing=thing, height_m=HOVER_M, turn_rad=turn_rad))
    return TaskStep("above", thing, f"above the {thing}", Above(thing, 0.02, 0.05, 0.2), (high,))


def stab(thing: str, turn_rad: float | None = None, half_m: float = MARSHMALLOW_HALF_M) -> TaskStep:
    """Go straight down into food, and lift it.

    Args:
        thing: its name.
        turn_rad: see `latentarm.tasks.eating.table.fork`.
        half_m: half of its height, m.
    """
    above_it = partial(over, thing=thing, turn_rad=turn_rad)
    lying_m = STAND_M + half_m
    near = Waypoint(partial(above_it, height_m=half_m + 0.02), within_m=0.008, speed=0.6)
    into = Waypoint(
        partial(above_it, height_m=-INTO_M),
        within_m=0.008,
        wait_s=0.1,
        speed=0.4,
        until=Taken(thing),
    )
    lifted = Waypoint(partial(_over_plate, thing=thing, height_m=lying_m + HOVER_M, turn_rad=turn_rad))
    done = Stabbed(thing, lying_m + LIFTED_M)
    return TaskStep("stabbed", thing, f"the {thing} on the fork", done, (near, into, lifted))


def over(
    state: SceneState,
    thing: str,
    height_m: float,
    turn_rad: float | None = None,
    tilt_rad: float = 0.0,
    out_m: float = 0.0,
) -> Pose:
    """The fork over a thing.

    Args:
        state: where that is now.
        thing: its name.
        height_m: of the fork's tip over it, m.
        turn_rad: see `latentarm.tasks.eating.table.fork`.
        tilt_rad: see the same.
        out_m: how far farther away from the arm's base, m.
    """
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
    """The fork where it brings food that it holds over a thing, however the food sits on it.

    Args:
        state: as things are now.
        food: its name; until the fork holds it, it is expected where `stab` takes it.
        thing: see `over`, as for the rest.
        height_m: of the fork's tip over the thing if the food sat as expected, m.
        turn_rad: see `over`.
        tilt_rad: see `over`.
        out_m: see `over`.
    """
    pose = over(state, thing, height_m, turn_rad, tilt_rad, out_m)
    if food not in state.stabbed:
        return pose
    sits = (state.poses[food].position - state.tool.position) @ state.tool.rotation
    away = np.array([0.0, 0.0, -INTO_M]) - sits
    return Pose(pose.position + pose.rotation @ away, pose.rotation)


def _over_plate(state: SceneState, thing: str, height_m: float, turn_rad: float | None) -> Pose:
    """The same, at a height in the base frame of the arm, wherever the thing is."""
    place = state.poses[thing].position.copy()
    place[2] = 0.0
    return fork(place, height_m, turn_rad)
