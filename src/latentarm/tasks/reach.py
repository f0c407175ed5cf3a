"""Any arm, reachable poses: the task for a robot of which nothing else is known."""

from functools import cached_property
from typing import final

import numpy as np

from latentarm.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import Hand, demonstrate
from latentarm.tasks.task import Task
from latentarm.tasks.tolerance import within
from latentarm.types import Demonstrations, Episode, FloatArray, Goal, Pose

SPREAD = 0.5
"""How far a goal's joints lie from home at most, rad."""

START_SPREAD = 0.1
"""How far a start's joints lie from home at most, rad."""

TRIES = 100
"""Starts and goals that are drawn before there is said to be none."""

MARGIN = 0.15
"""How far starts and goals stay from joint limits, rad."""


@final
class Reach(Task):
    """Bring the tool of any arm to poses about its home configuration, in free space.

    Args:
        robot: the arm.
        goals: how many poses.
        seed: which poses; the same seed gives the same task.

    Raises:
        UserError: fewer than one goal is asked for, or the tool hardly moves.
    """

    def __init__(self, robot: Robot, goals: int = 3, seed: int = 0) -> None:
        if goals < 1:
            raise UserError(f"Reaching needs at least one goal, not {goals}.")
        self._robot = robot
        self._count = goals
        self._seed = seed
        _ = self._goals  # raises now, not in the first drive, if there are no goals

    @property
    def name(self) -> str:
        """``reach``."""
        return "reach"

    @property
    def robot(self) -> Robot:
        """The arm."""
        return self._robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Poses about home."""
        return self._goals

    @property
    def manners(self) -> tuple[str, ...]:
        """One: to reach."""
        return ("reach",)

    @property
    def obstacles(self) -> tuple[()]:
        """None: nothing is known of the place."""
        return ()

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """About home and not yet at the goal, (n,), rad.

        Raises:
            UserError: the goal is wherever the arm could start.
        """
        for _ in range(TRIES):
            start = self._about_home(START_SPREAD, rng)
            if not self.reached(self.robot.chain.forward(start), self.goals[goal].pose):
                return start
        raise self._hardly_moves()

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """The goal's pose alone.

        Raises:
            UserError: there is no such goal or manner.
        """
        if not 0 <= goal < len(self.goals) or manner not in self.manners:
            raise UserError(f"One can reach the goals 0 to {len(self.goals) - 1}, not {manner!r} {goal}.")
        return (self.goals[goal].pose,)

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Within 0.03 m and 20 degrees."""
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Straight to the goals in turn, as a simulated person would.

        Raises:
            UserError: fewer than one episode is asked for.
        """
        if episodes < 1:
            raise UserError(f"Ask for at least one demonstration, not {episodes}.")
        hand = Hand()
        return Demonstrations(
            episodes=tuple(self._episode(index % self._count, hand, rng) for index in range(episodes)),
            rate_hz=hand.rate_hz,
            joint_names=self.robot.joint_names,
            robot=self.robot.name,
            goals=self.goals,
            end_effector=self.robot.end_effector,
            limits=self.robot.stated_limits,
        )

    def _episode(self, goal: int, hand: Hand, rng: np.random.Generator) -> Episode:
        stroke = self.goals[goal].configuration[None]
        state = demonstrate(self.robot.chain, self.sample_start(goal, rng), (stroke,), hand, rng)
        timestamp = np.arange(len(state)) / hand.rate_hz
        return Episode(state=state, timestamp=timestamp, task=f"reach {self.goals[goal].name}")

    @cached_property
    def _goals(self) -> tuple[Goal, ...]:
        rng = np.random.default_rng(self._seed)
        return tuple(self._goal(f"goal {index + 1}", rng) for index in range(self._count))

    def _goal(self, name: str, rng: np.random.Generator) -> Goal:
        """A goal that is not where the arm stands at home."""
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
        """Home with each joint moved at random, kept off the limits (half-way between narrow ones)."""
        limits = self.robot.limits
        middle = (limits.lower + limits.upper) / 2
        lowest = np.minimum(limits.lower + MARGIN, middle)
        highest = np.maximum(limits.upper - MARGIN, middle)
        moved = self.robot.home + rng.uniform(-spread, spread, self.robot.dof)
        return np.clip(moved, lowest, highest)
