"""The ways of demonstrations as a task, to test whether a model can do what people did."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import (
    BoolArray,
    Demonstrations,
    Episode,
    FloatArray,
    Goal,
    GripperAsk,
    IntArray,
    Pose,
)
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.kinematics.stillness import moving_range
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import demonstrate_goals
from latentarm.tasks.task import REACHED_ANGLE, REACHED_DISTANCE, Task, within

WAYPOINT_SPACING = 0.25  # way of the tool between two waypoints, m
RADIAN = 0.2  # equivalent way of a radian of turning, m


@final
@dataclass(frozen=True, eq=False)
class GripperRoutes:
    """Routes along which a gripper opens and closes."""

    states: tuple[FloatArray, ...]  # as from `routes_of`, with a waypoint at every new command to the gripper
    # (K + 1,) for each, 1 where the gripper is to be open from there on, and 0 where closed
    open_at: tuple[FloatArray, ...]


def gripper_routes_of(
    robot: Robot, demonstrations: Demonstrations, is_told_open: Callable[[Episode], BoolArray]
) -> GripperRoutes:
    """Routes of demonstrations with their commands to the gripper, open or not, (T,) per episode."""
    states: list[FloatArray] = []
    open_at: list[FloatArray] = []
    for episode in _leaving(robot, demonstrations):
        is_open = is_told_open(episode)
        told = np.flatnonzero(is_open[1:] != is_open[:-1]) + 1
        at = np.union1d(_stops(robot, episode.state), told)
        states.append(episode.state[at])
        open_at.append(is_open[at].astype(np.float64))
    return GripperRoutes(tuple(states), tuple(open_at))


def routes_of(robot: Robot, demonstrations: Demonstrations) -> tuple[FloatArray, ...]:
    """Each episode's start and waypoints to its end, (K + 1, n), rad, where its tool goes anywhere."""
    return tuple(one.state[_stops(robot, one.state)] for one in _leaving(robot, demonstrations))


@final
class Replay(Task):
    """Drive the ways of demonstrations (see `routes_of`), from their starts through poses along them.

    A goal is the end of an episode. Episodes that training never saw make this the honest test of a model on
    real demonstrations. ``open_at`` is the gripper along them, see `GripperRoutes`; empty for none.
    """

    name = "held_out"
    manners = ("follow",)
    obstacles = ()  # the place is unknown

    def __init__(
        self, robot: Robot, routes: Sequence[FloatArray], open_at: Sequence[FloatArray] = ()
    ) -> None:
        self._robot = robot
        self._routes = tuple(routes)
        self._open_at = tuple(open_at)

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The end of each episode."""
        chain = self._robot.chain
        return tuple(
            Goal(f"end {index + 1}", route[-1], chain.forward(route[-1]))
            for index, route in enumerate(self._routes)
        )

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """The start of the goal's episode, (n,), rad."""
        return self._route(goal)[0]

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """Poses along the goal's episode, the last one its end."""
        self._check(manner)
        poses = self._robot.chain.forward(self._route(goal)[1:])
        return tuple(Pose(*pose) for pose in zip(poses.position, poses.rotation, strict=True))

    def asks(self, goal: int, manner: str) -> tuple[GripperAsk, ...]:
        """The person's requests to the gripper: at the start, and from each waypoint on; () for none."""
        self._check(manner)
        self._route(goal)
        if not self._open_at:
            return ()
        return tuple("open" if is_open else "close" for is_open in self._open_at[goal])

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Strokes along the routes in turn, by a simulated person."""
        return demonstrate_goals(self, lambda goal: self._route(goal)[1:], "follow", episodes, rng)

    def _check(self, manner: str) -> None:
        if manner not in self.manners:
            raise UserError(f"A demonstration can be followed, not {manner!r}.")

    def _route(self, goal: int) -> FloatArray:
        if not 0 <= goal < len(self._routes):
            raise UserError(f"There are episodes 0 to {len(self._routes) - 1} to follow, not {goal}.")
        return self._routes[goal]


def _leaving(robot: Robot, demonstrations: Demonstrations) -> list[Episode]:
    """Episodes in which the tool goes somewhere, without the still samples at their ends."""
    found: list[Episode] = []
    for one in demonstrations.episodes:
        moving = one.at(slice(*moving_range(one.state, one.timestamp)))
        if len(moving.state) and _away(robot, moving.state).max() > 1.0:
            found.append(moving)
    if not found:
        tool = robot.chain.tools[0].name
        raise UserError(
            f"In none of these episodes does {tool} of {robot.name} go anywhere, so there is nothing to"
            " follow: see whether it is the end-effector that was recorded."
        )
    return found


def _stops(robot: Robot, path: FloatArray) -> IntArray:
    """Indices of an episode's start and waypoints, (K + 1,); at least one is away from the start."""
    poses = robot.chain.forward(path)
    turned = angle_between(poses.rotation[1:], poses.rotation[:-1])
    way = np.cumsum(np.linalg.norm(np.diff(poses.position, axis=0), axis=1) + RADIAN * turned)
    count = max(1, round(way[-1] / WAYPOINT_SPACING))
    at = np.searchsorted(way, way[-1] * np.arange(1, count) / count - 1e-9) + 1
    stops = np.array([0, *at, len(path) - 1])
    away = _away(robot, path)
    return stops if away[stops].max() > 1.0 else np.union1d(stops, away.argmax())


def _away(robot: Robot, path: FloatArray) -> FloatArray:
    """Distance of the tool from its start, (T,): up to 1 it is still there, see `within`."""
    poses = robot.chain.forward(path)
    distance = np.linalg.norm(poses.position - poses.position[0], axis=1)
    angle = angle_between(poses.rotation, poses.rotation[0])
    return np.maximum(distance / REACHED_DISTANCE, angle / REACHED_ANGLE)
