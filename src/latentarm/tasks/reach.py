"""Reachable poses for any arm: the task for a robot without a task of its own."""

from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, Goal, Pose
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import demonstrate_goals
from latentarm.tasks.task import Task, within

GOALS = 3
SPREAD = 0.5  # of a goal's joints about home, rad
START_SPREAD = 0.1  # of a start's joints about home, rad
TRIES = 100  # draws of a start or goal before giving up
MARGIN = 0.15  # of starts and goals to joint limits, rad


@final
class Reach(Task):
    """Bring the tool of any arm to poses about its home configuration, always the same, in free space."""

    any_robot = True
    name = "reach"
    manners = ("reach",)
    obstacles = ()  # the place is unknown

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        rng = np.random.default_rng(0)
        self._goals = tuple(self._goal(f"goal {index + 1}", rng) for index in range(GOALS))

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Poses about home."""
        return self._goals

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """About home and not yet at the goal, (n,), rad."""
        for _ in range(TRIES):
            start = self._about_home(START_SPREAD, rng)
            if not self.reached(self.robot.chain.forward(start), self.goals[goal].pose):
                return start
        raise self._hardly_moves()

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """The goal's pose alone."""
        if not 0 <= goal < len(self.goals) or manner not in self.manners:
            raise UserError(f"One can reach the goals 0 to {len(self.goals) - 1}, not {manner!r} {goal}.")
        return (self.goals[goal].pose,)

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Straight strokes to the goals in turn, by a simulated person."""
        return demonstrate_goals(
            self, lambda goal: self.goals[goal].configuration[None], "reach", episodes, rng
        )

    def _goal(self, name: str, rng: np.random.Generator) -> Goal:
        """A goal away from home."""
        chain = self.robot.chain
        home = chain.forward(self._about_home(0.0, rng))
        for _ in range(TRIES):
            configuration = self._about_home(SPREAD, rng)
            pose = chain.forward(configuration)
            if not self.reached(home, pose):
                return Goal(name, configuration, pose)
        raise self._hardly_moves()

    def _hardly_moves(self) -> UserError:
        tool = self.robot.chain.tools[0].name
        return UserError(
            f"There is nowhere to reach to: {tool} of {self.robot.name} hardly moves with the"
            f" {self.robot.dof} joints that move it. Choose another end-effector."
        )

    def _about_home(self, spread: float, rng: np.random.Generator) -> FloatArray:
        """Home with each joint moved at random, off the limits (half-way between narrow ones)."""
        limits = self.robot.limits
        middle = (limits.lower + limits.upper) / 2
        lowest = np.minimum(limits.lower + MARGIN, middle)
        highest = np.maximum(limits.upper - MARGIN, middle)
        moved = self.robot.home + rng.uniform(-spread, spread, self.robot.dof)
        return np.clip(moved, lowest, highest)
