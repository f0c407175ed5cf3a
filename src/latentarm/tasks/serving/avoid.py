"""A hand that goes round a bottle: *Avoid* of the paper's fourth user study, in physics."""

from functools import partial
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Goal, Pose
from latentarm.robots.scene.scene import Scene, SceneState
from latentarm.robots.scene.thing import Part, Thing
from latentarm.tasks.eating.table import at
from latentarm.tasks.predicates import KnockedOver, Pressed
from latentarm.tasks.scene_task import Beginning, Region, anywhere
from latentarm.tasks.serving.counter import TOP_M, bearing_of, counter, hand
from latentarm.tasks.serving.counter_task import CounterTask
from latentarm.tasks.serving.cup_steps import at_place
from latentarm.tasks.steps import TaskStep, Waypoint

BOTTLE_AT_M: Final[Region] = ((0.60, 0.66), (-0.05, 0.05))  # the bottle, x and y
GOAL_AT_M: Final[Region] = ((0.56, 0.62), (0.24, 0.30))  # the hand's goal
START_AT_M: Final[Region] = ((0.56, 0.62), (-0.30, -0.24))  # its start
PLANE_M: Final = TOP_M + 0.12  # height of the hand's plane
ROUND_M: Final = 0.16  # distance of the hand's way before the bottle's middle
TOUCHED_N: Final = 0.5  # a harder touch is a failure
_HALF_M: Final = 0.11
_RADIUS_M: Final = 0.03


@final
class Avoid(CounterTask):
    """Guide the hand in a plane past a bottle to a place behind it."""

    name = "avoid"
    choices = ("place",)
    time_limit_s = 60.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Bottle, start and goal at random in their regions."""
        bottle = _bottle(*anywhere(BOTTLE_AT_M, rng))
        goal = np.append(anywhere(GOAL_AT_M, rng), PLANE_M)
        place = np.append(anywhere(START_AT_M, rng), PLANE_M)
        past = Waypoint(_before_bottle, within_m=0.03, within_rad=0.35)
        there = Waypoint(partial(at_place, place=goal), within_m=0.03, within_rad=0.35)
        return Beginning(
            state=self.reaching(place),
            scene=Scene((counter(), bottle)),
            steps=(
                TaskStep("passed", "bottle", "past the bottle", _past, (past, there)),
                TaskStep("reached", "place", "at the place", there.reached, (there,)),
            ),
            failures=(Pressed("bottle", TOUCHED_N), KnockedOver("bottle")),
            goals=(Goal("place", self.reaching(goal), hand(goal, bearing_of(goal))),),
            objects=("bottle",),
            text="go round the bottle",
        )


def _bottle(x: float, y: float) -> Thing:
    glass = Part("cylinder", (_RADIUS_M, _HALF_M), (0.0, 0.0, _HALF_M), colour=(0.25, 0.5, 0.35, 1.0))
    return Thing("bottle", (glass,), mass_kg=0.4, pose=at(x, y, TOP_M))


def _past(state: SceneState) -> bool:
    return bool(state.tool.position[1] > state.poses["bottle"].position[1])


def _before_bottle(state: SceneState) -> Pose:
    place: FloatArray = state.poses["bottle"].position.copy()
    bearing = bearing_of(place)
    place -= ROUND_M * np.array([np.cos(bearing), np.sin(bearing), 0.0])
    place[2] = PLANE_M
    return hand(place, bearing)
