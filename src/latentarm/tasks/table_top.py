"""A Panda at a table with three food items, each to reach and then to stab or scoop."""

from collections.abc import Mapping
from functools import cached_property
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Goal, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part, Thing
from latentarm.tasks.demonstrator import Hand, demonstrate, demonstrations_of
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.task import Task, within

TABLE_HEIGHT = 0.0  # in the robot's base frame, m: the arm stands on the table
ITEMS = {"carrot": (0.50, -0.28), "tofu": (0.60, 0.0), "melon": (0.50, 0.28)}
"""x and y of the food, m; each item lies on a raised dish."""

ITEM_HEIGHT = 0.10  # above the table top, m
HOVER = 0.13  # height of a reach's end above the food, m
SCOOP_TILT = 0.45  # of the tool, its tip outwards, rad
SCOOP_SWEEP = (-0.03, 0.04)  # start and end of a scoop, m outwards from the food's middle
START_SPREAD = np.array([0.3, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05])
"""How far each joint may start from the ready pose, rad: mostly turned about the base."""

NEXT_BITE = 0.15  # share of demonstrations that begin above another item
_VIA = 3  # configurations along a stab or scoop, so that the tool follows a line

_PLATE_RADIUS_M: Final = 0.06
_PLATE_HALF_M: Final = 0.005
_HALF_M: Final = 0.014  # half the height of every item
_CHINA: Final = (0.95, 0.95, 0.97, 1.0)
_WOOD: Final = (0.62, 0.47, 0.33, 1.0)
_ALONG_Y: Final = (float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0)
_FOOD: Final[Mapping[str, Part]] = {
    "carrot": Part("capsule", (_HALF_M, 0.025), quaternion=_ALONG_Y, colour=(0.93, 0.45, 0.10, 1.0)),
    "tofu": Part("box", (0.020, 0.020, _HALF_M), colour=(0.93, 0.86, 0.66, 1.0)),
    "melon": Part("sphere", (_HALF_M,), colour=(0.35, 0.62, 0.25, 1.0)),
}
"""The items as they are drawn, each on a dish of its own."""


@final
class TableTop(Task):
    """Three food items on a table, in an arc in front of a Panda whose hand holds a fork.

    The tool point stands for the fork's tip, and its z axis for the fork's direction. A goal is the
    configuration with the fork upright above an item, turned outwards from the base. To stab, the fork goes
    straight down from there; to scoop, it tilts, goes low before the item and sweeps outwards through it. The
    demonstrator is a simulated person.
    """

    name = "table_top"
    manners = ("stab", "scoop")
    # The table; the arm may touch the soft food and its dishes.
    obstacles = (HalfSpace("table", np.array([0.0, 0.0, TABLE_HEIGHT]), np.array([0.0, 0.0, 1.0])),)

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def shown(self) -> Scene:
        height_m = TABLE_HEIGHT + ITEM_HEIGHT
        dishes = (_dish(name, *place, height_m - _HALF_M) for name, place in ITEMS.items())
        return Scene((*dishes, *(_item(name, *place, height_m) for name, place in ITEMS.items())))

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Above each item, the fork upright."""
        return self._goals

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """About the ready pose, above and before the items: (7,), rad."""
        return self.robot.home + rng.uniform(-START_SPREAD, START_SPREAD)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        if not 0 <= goal < len(ITEMS):
            raise UserError(f"The table has goals 0 to {len(ITEMS) - 1}, not {goal}.")
        return self.goals[goal].pose, self.robot.chain.forward(self._manipulation(goal, manner)[-1])

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Reach and manipulate, goals and manners in turn, by a simulated person."""
        hand = Hand()
        return demonstrations_of(self, lambda index: self._episode(index, hand, rng), episodes, hand)

    def _episode(self, index: int, hand: Hand, rng: np.random.Generator) -> Episode:
        goal = index % len(ITEMS)
        manner = self.manners[index // len(ITEMS) % len(self.manners)]
        strokes = (self.goals[goal].configuration[None], self._manipulation(goal, manner))
        start = self.sample_start(goal, rng)
        if rng.random() < NEXT_BITE:
            other = (goal + rng.integers(1, len(ITEMS))) % len(ITEMS)
            start = self.goals[other].configuration + rng.normal(0.0, hand.spread, self.robot.dof)
        state = demonstrate(self.robot.chain, start, strokes, hand, rng)
        return Episode(
            state=state,
            timestamp=np.arange(len(state)) / hand.rate_hz,
            task=f"{manner} the {self.goals[goal].name}",
        )

    @cached_property
    def _robot(self) -> Robot:
        return load_robot("panda")

    @cached_property
    def _goals(self) -> tuple[Goal, ...]:
        return tuple(self._goal(name) for name in ITEMS)

    def _goal(self, name: str) -> Goal:
        outwards = np.arctan2(ITEMS[name][1], ITEMS[name][0])
        posture = self.robot.home.copy()
        posture[0] = outwards
        configuration = solve(self.robot, _above(name, height=HOVER), posture)
        return Goal(name, configuration, self.robot.chain.forward(configuration))

    def _manipulation(self, goal: int, manner: str) -> FloatArray:
        if manner not in self.manners:
            raise UserError(f"At the table one can {' or '.join(self.manners)}, not {manner!r}.")
        return self._manipulations[goal, manner]

    @cached_property
    def _manipulations(self) -> dict[tuple[int, str], FloatArray]:
        return {
            (index, manner): self._along(goal, _line(goal.name, manner))
            for index, goal in enumerate(self.goals)
            for manner in self.manners
        }

    def _along(self, goal: Goal, poses: list[Pose]) -> FloatArray:
        """Configurations (V, n), rad, for poses in turn, each found from the one before."""
        configurations = [goal.configuration]
        for pose in poses:
            configurations.append(solve(self.robot, pose, configurations[-1]))
        return np.stack(configurations[1:])


def _line(name: str, manner: str) -> list[Pose]:
    share = np.linspace(0.0, 1.0, _VIA + 2)[1:]
    if manner == "stab":
        return [_above(name, height=HOVER * (1.0 - s)) for s in share]
    enter, leave = SCOOP_SWEEP
    lower = [
        _above(name, height=HOVER * (1.0 - s), tilt=SCOOP_TILT * s / 2, outwards=enter * s) for s in share
    ]
    sweep = [
        _above(name, height=0.0, tilt=SCOOP_TILT * (1.0 + s) / 2, outwards=enter + (leave - enter) * s)
        for s in share
    ]
    return lower + sweep


def _above(name: str, height: float, tilt: float = 0.0, outwards: float = 0.0) -> Pose:
    x, y = ITEMS[name]
    direction = np.array([x, y]) / np.hypot(x, y)
    out = np.array([*direction, 0.0])
    points = np.sin(tilt) * out + np.array([0.0, 0.0, -np.cos(tilt)])
    side = np.array([direction[1], -direction[0], 0.0])
    rotation = np.stack([np.cross(side, points), side, points], axis=-1)
    position = np.array([x, y, TABLE_HEIGHT + ITEM_HEIGHT + height]) + outwards * out
    return Pose(position, rotation)


def _dish(item: str, x: float, y: float, top_m: float) -> Thing:
    half = (top_m - 2 * _PLATE_HALF_M) / 2
    disc = Part("cylinder", (_PLATE_RADIUS_M, _PLATE_HALF_M), (0.0, 0.0, -_PLATE_HALF_M), colour=_CHINA)
    below = -2 * _PLATE_HALF_M - half
    stand = Part("cylinder", (0.5 * _PLATE_RADIUS_M, half), (0.0, 0.0, below), colour=_WOOD)
    return Thing(f"{item} dish", (disc, stand), 0.5, Pose(np.array([x, y, top_m]), np.eye(3)), fixed=True)


def _item(name: str, x: float, y: float, height_m: float) -> Thing:
    return Thing(name, (_FOOD[name],), 0.02, Pose(np.array([x, y, height_m]), np.eye(3)))
