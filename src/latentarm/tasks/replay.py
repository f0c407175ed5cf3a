"""Where demonstrations began and ended, as a task: to see whether a model can do what people did."""

from collections.abc import Sequence
from typing import final

import numpy as np

from latentarm.errors import UserError
from latentarm.kinematics.rotations import angle_between
from latentarm.kinematics.stillness import moving_range
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import demonstrate_goals
from latentarm.tasks.task import Task, within
from latentarm.types import Demonstrations, FloatArray, Goal, Pose

WAYPOINT_SPACING = 0.25
"""Way of the tool between two waypoints, m, a radian of turning counted as `RADIAN`."""

RADIAN = 0.2
"""What a radian of turning counts as way, m."""


def routes_of(robot: Robot, demonstrations: Demonstrations) -> tuple[FloatArray, ...]:
    """The ways that demonstrations went.

    Args:
        robot: the arm that was recorded.
        demonstrations: the episodes to follow; those in which the tool goes nowhere are left out.

    Returns:
        For each episode its start and then the waypoints along it, the last one its end: (K + 1, n), rad.

    Raises:
        UserError: the tool goes nowhere in any of them.
    """
    moving = [one.state[slice(*moving_range(one.state, one.timestamp))] for one in demonstrations.episodes]
    routes = tuple(_route(robot, path) for path in moving if len(path) and _leaves(robot, path))
    if not routes:
        tool = robot.chain.tools[0].name
        raise UserError(
            f"In none of these episodes does {tool} of {robot.name} go anywhere, so there is nothing to"
            " follow: see whether it is the end-effector that was recorded."
        )
    return routes


@final
class Replay(Task):
    """Drive the way that demonstrations went, from where they began, through poses along them.

    A goal is where an episode ended. Episodes that training never saw make this the honest test of
    a model on real demonstrations, for which nothing else is known of the task.

    Args:
        robot: the arm that was recorded.
        routes: one or more, see `routes_of`.
    """

    def __init__(self, robot: Robot, routes: Sequence[FloatArray]) -> None:
        self._robot = robot
        self._routes = tuple(routes)

    @property
    def name(self) -> str:
        """``held_out``."""
        return "held_out"

    @property
    def robot(self) -> Robot:
        """The arm that was recorded."""
        return self._robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Where each episode ended."""
        chain = self._robot.chain
        return tuple(
            Goal(f"end {index + 1}", route[-1], chain.forward(route[-1]))
            for index, route in enumerate(self._routes)
        )

    @property
    def manners(self) -> tuple[str, ...]:
        """One: the way the person went."""
        return ("follow",)

    @property
    def obstacles(self) -> tuple[()]:
        """None: nothing is known of the place."""
        return ()

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """Where the goal's episode began, (n,), rad."""
        return self._route(goal)[0]

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """Poses along the goal's episode, the last one its end.

        Raises:
            UserError: there is no such goal or manner.
        """
        if manner not in self.manners:
            raise UserError(f"A demonstration can be followed, not {manner!r}.")
        poses = self._robot.chain.forward(self._route(goal)[1:])
        return tuple(Pose(*pose) for pose in zip(poses.position, poses.rotation, strict=True))

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Within 0.03 m and 20 degrees."""
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Along the routes in turn, as a simulated person would.

        Raises:
            UserError: fewer than one episode is asked for.
        """
        return demonstrate_goals(self, lambda goal: self._route(goal)[1:], "follow", episodes, rng)

    def _route(self, goal: int) -> FloatArray:
        if not 0 <= goal < len(self._routes):
            raise UserError(f"There are episodes 0 to {len(self._routes) - 1} to follow, not {goal}.")
        return self._routes[goal]


def _route(robot: Robot, path: FloatArray) -> FloatArray:
    """A start and waypoints (K + 1, n) out of the states (T, n) of an episode."""
    poses = robot.chain.forward(path)
    turned = angle_between(poses.rotation[1:], poses.rotation[:-1])
    way = np.cumsum(np.linalg.norm(np.diff(poses.position, axis=0), axis=1) + RADIAN * turned)
    count = max(1, round(way[-1] / WAYPOINT_SPACING))
    at = np.searchsorted(way, way[-1] * np.arange(1, count) / count - 1e-9) + 1
    return path[[0, *at, -1]]


def _leaves(robot: Robot, path: FloatArray) -> bool:
    """Whether the tool is ever anywhere but where it began."""
    poses = robot.chain.forward(path)
    start = Pose(poses.position[0], poses.rotation[0])
    return not all(within(start, Pose(*pose)) for pose in zip(poses.position, poses.rotation, strict=True))
