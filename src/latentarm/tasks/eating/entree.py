"""A slice of tofu that is cut off, stabbed and brought to a plate: the paper's *Entree*, in physics."""

from functools import partial
from typing import Final, final

import numpy as np

from latentarm.core.types import Pose
from latentarm.robots.scene.scene import Scene, SceneState
from latentarm.robots.scene.thing import Bond, Food, Part, Thing
from latentarm.tasks.eating.fork_task import ForkTask, fallen
from latentarm.tasks.eating.stabbing import above, carried_over, stab
from latentarm.tasks.eating.table import PLATE_RADIUS_M, STAND_M, at, fork, plate
from latentarm.tasks.predicates import Apart, CarriedOver, Placed
from latentarm.tasks.scene_task import Beginning
from latentarm.tasks.steps import TaskStep, Waypoint

DISH_M: Final = (0.50, 0.14)  # x and y of the dish with the tofu
OWN_M: Final = (0.50, -0.14)  # of the person's own plate
SPREAD_M: Final = 0.02  # largest offset of the tofu along each axis
TURN_RAD: Final = 0.3  # largest turn to either side
TOFU: Final = Food(pierce_n=0.6, depth_m=0.008, grip_n=2.5)
"""Chosen: firm tofu, softer than a marshmallow's skin."""

HALF_M: Final = (0.018, 0.016, 0.012)  # half lengths of the block
SLICE_HALF_M: Final = 0.008  # half the thickness of the slice, along the block's y axis
EDGE_RAD: Final = float(np.deg2rad(25.0))  # largest turn of the fork's edge out of the cut's plane
_COLOUR: Final = (0.96, 0.93, 0.82, 1.0)


@final
class Entree(ForkTask):
    """Cut a slice of tofu with the edge of the fork, stab it, and bring it to the person's own plate."""

    name = "entree"
    choices = ("slice",)
    time_limit_s = 120.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Tofu at random near the middle of its dish, turned a little."""
        turn = float(rng.uniform(-TURN_RAD, TURN_RAD))
        x, y = np.array(DISH_M) + rng.uniform(-SPREAD_M, SPREAD_M, 2)
        scene = Scene(
            things=(plate("dish", *DISH_M), plate("own plate", *OWN_M), *tofu(float(x), float(y), turn)),
            bonds=(cut_between(),),
        )
        return Beginning(
            state=self.start(rng),
            scene=scene,
            steps=self._steps(turn),
            failures=fallen("tofu", "slice"),
            goals=self.goals((scene.thing("slice"), scene.thing("own plate")), np.pi / 2),
            objects=("tofu", "slice", "own plate"),
            text="cut a slice of tofu and bring it to the plate",
        )

    def _steps(self, turn: float) -> tuple[TaskStep, ...]:
        along, apart = turn + np.pi / 2, Apart("tofu", "slice")
        ready = Waypoint(partial(_at_cut, height_m=0.04, turn_rad=along), within_m=0.008, within_rad=0.2)
        through = Waypoint(
            partial(_at_cut, height_m=-2.0 * HALF_M[2] + 0.003, turn_rad=along),
            within_m=0.006,
            within_rad=0.2,
            speed=0.5,
            until=apart,
        )
        out = Waypoint(partial(_at_cut, height_m=0.05, turn_rad=along), within_rad=0.3)
        over_plate = partial(carried_over, food="slice", thing="own plate", turn_rad=along)
        high = Waypoint(partial(over_plate, height_m=0.10))
        down = Waypoint(partial(over_plate, height_m=HALF_M[2] + 0.006), wait_s=0.5, speed=0.5)
        centre = np.array([*OWN_M, STAND_M + HALF_M[2]])
        carried = CarriedOver("slice", "own plate", 0.03)
        laid = Placed("slice", centre, np.array([*(2 * [0.7 * PLATE_RADIUS_M]), 0.015]), let_go=False)
        return (
            above("slice", along),
            TaskStep("cut", "slice", "a slice cut off", apart, (ready, through, out)),
            stab("slice", along, HALF_M[2]),
            TaskStep("above", "own plate", "above the plate", carried, (high,), "slice"),
            TaskStep("placed", "own plate", "the slice on the plate", laid, (high, down), "slice"),
        )


def tofu(x: float, y: float, turn_rad: float) -> tuple[Thing, Thing]:
    """The block, and the slice that is still part of it."""
    z = STAND_M + HALF_M[2]
    pose = at(x, y, z, turn_rad)
    beyond = pose.rotation @ np.array([0.0, HALF_M[1] + SLICE_HALF_M, 0.0])
    block = Part("box", HALF_M, colour=_COLOUR)
    piece = Part("box", (HALF_M[0], SLICE_HALF_M, HALF_M[2]), colour=_COLOUR)
    there = Pose(pose.position + beyond, pose.rotation)
    return (
        Thing("tofu", (block,), mass_kg=0.03, pose=pose, friction=0.9, food=TOFU),
        Thing("slice", (piece,), mass_kg=0.012, pose=there, friction=0.9, food=TOFU),
    )


def cut_between() -> Bond:
    """The bond between slice and block."""
    cut = (0.0, HALF_M[1], HALF_M[2])
    return Bond("tofu", "slice", cut, (0.0, 1.0, 0.0), depth_m=1.6 * HALF_M[2], angle_rad=EDGE_RAD)


def _at_cut(state: SceneState, height_m: float, turn_rad: float) -> Pose:
    pose = state.poses["tofu"]
    place = pose.position + pose.rotation @ np.array([0.0, HALF_M[1], HALF_M[2]])
    return fork(place, height_m, turn_rad)
