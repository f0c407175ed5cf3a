"""Eggs, flour and an apple for a pie: the paper's second user study, in physics."""

from collections.abc import Mapping
from functools import partial
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.containers import bowl, cup
from latentarm.robots.scene.scene import Scene, SceneState
from latentarm.robots.scene.thing import Interior, Part, Thing
from latentarm.tasks.eating.table import at
from latentarm.tasks.predicates import CarriedOver, KnockedOver, Placed, Stirred, Within
from latentarm.tasks.scene_task import Beginning, Region, anywhere
from latentarm.tasks.serving.counter import (
    BOWL_HEIGHT_M,
    FLOUR,
    GRAIN_KG,
    GRAIN_RADIUS_M,
    GRIP_M,
    TOP_M,
    counter,
    counter_bowl,
    counter_cup,
    filled,
)
from latentarm.tasks.serving.counter_task import CounterTask, fallen, spilled
from latentarm.tasks.serving.cup_steps import LIFT_M, POURED, at_place, over, pour, take
from latentarm.tasks.steps import TaskStep, Waypoint

SHELF_AT_M: Final[Region] = ((0.57, 0.61), (-0.27, -0.23))  # the shelf's middle, x and y
BOWL_AT_M: Final[Region] = ((0.55, 0.60), (0.05, 0.09))  # the bowl
MIXING_RADIUS_M: Final = 0.075  # of the bowl's floor: an apple and a spoon fit side by side
BIN_AT_M: Final[Region] = ((0.50, 0.54), (0.34, 0.38))  # the recycling bin
SPOON_AT_M: Final = (0.72, -0.08)  # the spoon in its holder
SHELF_M: Final = 0.02  # height of the shelf over the counter
APART_M: Final = 0.16  # between things on the shelf
CHOICES: Final = ("eggs", "flour", "apple")
EGGS: Final = 6
EGG_RADIUS_M: Final = 0.008
EGG_KG: Final = 0.004
GRAINS: Final = 30
APPLE_RADIUS_M: Final = 0.028
STAND_M: Final = 0.05  # height of the apple over the shelf: the hand stays over the cups
SPOON_M: Final = 0.17  # length of the spoon
STIR_TURNS: Final = 1.5
STIR_RADIUS_M: Final = 0.05
STIR_RAD: Final = 0.9  # sweep of the spoon to either side, opposite the apple
STIR_STROKES: Final = 6
STROKE_M: Final = 0.009  # tolerance at the end of a stroke: there is 12 mm of room under the spoon


@final
class ApplePie(CounterTask):
    """Pour eggs into a bowl and drop their cup into the bin; flour, and put it back; an apple, and stir."""

    name = "apple_pie"
    choices = CHOICES  # between them the arm goes back to its start, as in the paper
    time_limit_s = 180.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Shelf, bowl and bin at random in their regions."""
        shelf = np.append(anywhere(SHELF_AT_M, rng), TOP_M + SHELF_M)
        things = _things(shelf, anywhere(BOWL_AT_M, rng), anywhere(BIN_AT_M, rng))
        grains = (
            filled("eggs", things["egg cup"], EGGS, EGG_RADIUS_M, EGG_KG, _YOLK),
            filled("flour", things["flour cup"], GRAINS, GRAIN_RADIUS_M, GRAIN_KG, FLOUR),
        )
        rooms = {name: things[name].room for name in ("bowl", "bin", "egg cup", "flour cup")}
        what = CHOICES[choice]
        return Beginning(
            state=self.start(rng),
            scene=Scene(tuple(things.values()), grains),
            steps=_STEPS[what](things, rooms),
            failures=(
                *fallen("egg cup", "flour cup", "apple", "spoon"),
                *(KnockedOver(name) for name in ("egg cup", "flour cup") if not name.startswith(what[:3])),
                *(spilled(name, things["bowl"]) for name in CHOICES[:2]),
            ),
            goals=(),
            objects=("egg cup", "flour cup", "apple", "spoon", "bowl", "bin", "shelf"),
            text=f"the {what} of the pie",
        )


_YOLK: Final = (0.95, 0.75, 0.3, 1.0)


def _things(shelf: FloatArray, bowl_at: FloatArray, bin_at: FloatArray) -> dict[str, Thing]:
    half = (0.05, APART_M + 0.05, SHELF_M / 2)
    board = Part("box", half, (0.0, 0.0, -SHELF_M / 2), colour=(0.8, 0.7, 0.55, 1.0))
    stand = Part("cylinder", (0.02, STAND_M / 2), (0.0, -APART_M, STAND_M / 2), colour=(0.8, 0.7, 0.55, 1.0))
    cups = {"egg cup": (APART_M, (0.85, 0.85, 0.88, 1.0)), "flour cup": (0.0, (0.45, 0.35, 0.6, 1.0))}
    things = [
        counter(),
        Thing("shelf", (board, stand), 2.0, at(*shelf), fixed=True),
        counter_bowl("bowl", *bowl_at, radius_m=MIXING_RADIUS_M),
        _bin(*bin_at),
        *_spoon(*SPOON_AT_M),
        _apple(shelf + np.array([0.0, -APART_M, STAND_M])),
    ]
    things += [
        counter_cup(name, shelf[0], shelf[1] + aside, colour, SHELF_M)
        for name, (aside, colour) in cups.items()
    ]
    return {thing.name: thing for thing in things}


def _bin(x: float, y: float) -> Thing:
    made = bowl(0.06, 0.09, (0.25, 0.45, 0.3, 1.0))
    return Thing("bin", made.parts, 0.5, at(x, y, TOP_M), fixed=True, interior=made.interior)


def _apple(place: FloatArray) -> Thing:
    """An apple that stands on its flat end, with its frame in the middle of that."""
    flesh = Part("sphere", (APPLE_RADIUS_M,), (0.0, 0.0, APPLE_RADIUS_M), colour=(0.8, 0.15, 0.15, 1.0))
    end = Part("cylinder", (0.014, 0.004), (0.0, 0.0, 0.004), colour=(0.8, 0.15, 0.15, 1.0))
    return Thing("apple", (flesh, end), 0.10, Pose(place, np.eye(3)), friction=0.9)


def _spoon(x: float, y: float) -> tuple[Thing, Thing]:
    """A spoon that stands in a holder, with its frame in the middle of its lower end."""
    made = cup(0.016, 0.06, (0.5, 0.5, 0.52, 1.0))
    holder = Thing("holder", made.parts, 0.3, at(x, y, TOP_M), fixed=True)
    steel = (0.7, 0.7, 0.72, 1.0)
    handle = Part("box", (0.008, 0.008, SPOON_M / 2 - 0.008), (0.0, 0.0, SPOON_M / 2 + 0.008), colour=steel)
    end = Part("sphere", (0.012,), (0.0, 0.0, 0.012), colour=steel)
    # Its handle is flat to the fingers of a hand that comes from the base.
    pose = at(x, y, TOP_M + 0.003, float(np.arctan2(y, x)))
    return holder, Thing("spoon", (handle, end), 0.05, pose, friction=1.0)


def _eggs(things: Mapping[str, Thing], rooms: Mapping[str, Interior]) -> tuple[TaskStep, ...]:
    return (
        *take("egg cup", TOP_M + SHELF_M),
        *pour("egg cup", "eggs", "bowl", rooms["bowl"], POURED, side=1.0),
        _away("egg cup", rooms["bin"]),
    )


def _flour(things: Mapping[str, Thing], rooms: Mapping[str, Interior]) -> tuple[TaskStep, ...]:
    back = things["flour cup"].pose.position
    return (
        *take("flour cup", TOP_M + SHELF_M),
        *pour("flour cup", "flour", "bowl", rooms["bowl"], POURED, side=1.0),
        _back("flour cup", back),
    )


def _apple_steps(things: Mapping[str, Thing], rooms: Mapping[str, Interior]) -> tuple[TaskStep, ...]:
    carry = Waypoint(partial(over, thing="bowl", height_m=0.22))
    drop = Waypoint(partial(over, thing="bowl", height_m=0.10), gripper="open", wait_s=0.8)
    spoon_up = 0.115
    strokes = _Strokes(spoon_up + 0.012)
    enter = Waypoint(partial(strokes.pose, index=0, up_m=BOWL_HEIGHT_M + 0.03))
    to_and_fro = [Waypoint(partial(strokes.pose, index=i), within_m=STROKE_M) for i in range(STIR_STROKES)]
    above = Waypoint(partial(over, thing="bowl", height_m=spoon_up + 0.10))
    apple_in = Within("apple", "bowl", rooms["bowl"])
    stirred = Stirred("spoon", "bowl", rooms["bowl"], STIR_TURNS)
    return (
        *take("apple", TOP_M + SHELF_M + STAND_M, APPLE_RADIUS_M),
        TaskStep(
            "above", "bowl", "the apple over the bowl", CarriedOver("apple", "bowl", 0.04), (carry,), "apple"
        ),
        TaskStep("placed", "bowl", "the apple in the bowl", apple_in, (carry, drop), "apple"),
        *take("spoon", TOP_M, spoon_up),
        TaskStep(
            "above", "bowl", "the spoon over the bowl", CarriedOver("spoon", "bowl", 0.04), (above,), "spoon"
        ),
        TaskStep("stirred", "bowl", "stirred", stirred, (enter, *to_and_fro), "spoon"),
    )


def _away(cup: str, room: Interior) -> TaskStep:
    upright = Waypoint(partial(over, thing="bowl", height_m=0.20), within_rad=0.5)
    above = Waypoint(partial(over, thing="bin", height_m=0.22))
    let_go = Waypoint(partial(over, thing="bin", height_m=0.17), gripper="open", wait_s=0.8)
    return TaskStep(
        "placed", "bin", f"the {cup} in the bin", Within(cup, "bin", room), (upright, above, let_go), cup
    )


def _back(cup: str, place: FloatArray) -> TaskStep:
    grip = place + np.array([0.0, 0.0, GRIP_M + 0.004])
    lift = np.array([0.0, 0.0, LIFT_M])
    upright = Waypoint(partial(over, thing="bowl", height_m=0.20), within_rad=0.5)
    above = Waypoint(partial(at_place, place=grip + lift))
    down = Waypoint(partial(at_place, place=grip), within_m=0.012, gripper="open", wait_s=0.8, speed=0.5)
    clear = Waypoint(partial(at_place, place=grip, back_m=0.08), speed=0.6)
    done = Placed(cup, place, np.array([0.05, 0.05, 0.015]), let_go=True)
    way = (upright, above, down, clear)
    return TaskStep("placed", "shelf", f"the {cup} back on the shelf", done, way, cup)


@final
class _Strokes:
    """The hand's strokes with the spoon on the side of the bowl opposite the apple."""

    def __init__(self, up_m: float) -> None:
        self._up_m = up_m
        self._entered_rad = 0.0

    def pose(self, state: SceneState, index: int, up_m: float = 0.0) -> Pose:
        """An end of a stroke, or over it; the side is fixed while the spoon is over the bowl."""
        middle = state.poses["bowl"].position
        if state.poses["spoon"].position[2] > middle[2] + BOWL_HEIGHT_M:
            apple = state.poses["apple"].position - middle
            self._entered_rad = float(np.arctan2(apple[1], apple[0])) + np.pi
        angle = self._entered_rad + (STIR_RAD if index % 2 else -STIR_RAD)
        circle = STIR_RADIUS_M * np.array([np.cos(angle), np.sin(angle), 0.0])
        return at_place(state, middle + circle + np.array([0.0, 0.0, self._up_m + up_m]))


_STEPS: Final = {"eggs": _eggs, "flour": _flour, "apple": _apple_steps}
