"""Steps of tasks with cups: take one and pour it out."""

from functools import partial
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.robots.scene.thing import Interior
from latentarm.tasks.predicates import CarriedOver, Lifted, Poured, Taken
from latentarm.tasks.serving.counter import GRIP_M, TOP_M, bearing_of, hand, pouring
from latentarm.tasks.steps import TaskStep, Waypoint

BEFORE_M: Final = 0.08  # first stop before a cup
LIFT_M: Final = 0.14  # lift of a cup
LIFTED_M: Final = 0.10  # height at which it counts as held: over all things next to it
POURING_M: Final = 0.14  # height of the fingers over a bowl's rim
POURED: Final = 0.8  # share of a cup's grains that must end in the bowl
POUR_RAD: Final = 1.8  # tilt that empties a cup


def take(cup: str, stands_m: float = TOP_M, grip_m: float = GRIP_M) -> tuple[TaskStep, ...]:
    """Take a cup that stands at a height, ``grip_m`` above its underside, and lift it."""
    before = Waypoint(partial(_at, cup=cup, back_m=BEFORE_M, up_m=grip_m), gripper="open")
    about = Waypoint(
        partial(_at, cup=cup, back_m=0.0, up_m=grip_m),
        within_m=0.007,
        gripper="close",
        wait_s=1.2,
        speed=0.6,
        until=Taken(cup),
    )
    lifted = Waypoint(partial(_lifted, cup=cup, height_m=stands_m + grip_m + LIFT_M))
    return (
        TaskStep("reached", cup, f"at the {cup}", before.reached, (before,)),
        TaskStep(
            "holding", cup, f"holding the {cup}", Lifted(cup, stands_m + LIFTED_M), (before, about, lifted)
        ),
    )


def pour(
    cup: str,
    grains: str,
    bowl: str,
    interior: Interior,
    share: float,
    side: float,
    tip_speed: float = 0.5,
    leaving: tuple[str, float] | None = None,
) -> tuple[TaskStep, ...]:
    """Carry a cup over a bowl, and pour the given share of its grains into it.

    ``side`` is 1 to pour to the left and -1 to the right; ``tip_speed`` is a share of the person's usual
    speed. ``leaving`` is the bowl and side of a pour before this: the cup is first set upright there.
    """
    upright = Waypoint(partial(_over, bowl=bowl, tilt_rad=0.05 * side))
    half = Waypoint(partial(_over, bowl=bowl, tilt_rad=0.6 * POUR_RAD * side), speed=0.7)
    tilted = Waypoint(partial(_over, bowl=bowl, tilt_rad=POUR_RAD * side), wait_s=1.0, speed=tip_speed)
    before = ()
    if leaving is not None:
        before = (Waypoint(partial(_over, bowl=leaving[0], tilt_rad=0.05 * leaving[1])),)
    enough = Poured(grains, bowl, interior, share)
    return (
        TaskStep("above", bowl, f"over the {bowl}", CarriedOver(cup, bowl, 0.10), (*before, upright), cup),
        TaskStep("poured", bowl, f"{grains} in the {bowl}", enough, (upright, half, tilted), cup),
    )


def _at(state: SceneState, cup: str, back_m: float, up_m: float) -> Pose:
    """The hand at a cup, or a little before it."""
    pose = state.poses[cup]
    # Along its own axis: a spoon leans in its holder.
    return at_place(state, pose.position + up_m * pose.rotation[:, 2], back_m)


def _lifted(state: SceneState, cup: str, height_m: float) -> Pose:
    place = state.poses[cup].position.copy()
    place[2] = height_m
    return at_place(state, place)


def _over(state: SceneState, bowl: str, tilt_rad: float) -> Pose:
    return pouring(state.poses[bowl].position, tilt_rad, POURING_M)


def over(state: SceneState, thing: str, height_m: float) -> Pose:
    """The hand upright over a thing that stands on the counter."""
    return at_place(state, state.poses[thing].position + np.array([0.0, 0.0, height_m]))


def at_place(state: SceneState, place: FloatArray, back_m: float = 0.0) -> Pose:
    """The hand over a place of the counter, or a little before it."""
    bearing = bearing_of(place)
    out = np.array([np.cos(bearing), np.sin(bearing), 0.0])
    return hand(place - back_m * out + np.array([0.0, 0.0, 0.5 * back_m]), bearing)
