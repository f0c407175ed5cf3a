"""The goals of Algorithm 1 at the steps of a task: they move on as the person does."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Goal, Pose
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.steps import TaskStep, Waypoint

STEPS: Final = 100
"""At most, of inverse kinematics: the page waits for it, and a pose within reach takes some 20."""

MOVED_M: Final = 0.002
MOVED_RAD: Final = 0.02  # a goal is solved for again once its pose has moved farther than this


@final
@dataclass(frozen=True, eq=False)
class GoalMove:
    """A change of the goals."""

    goals: FloatArray  # (G, n), configurations from now on, rad
    anew: bool  # whether a step at another thing begins, so that earlier inputs say nothing of the next goal


@final
class StepGoals:
    """Where the arm would be taken for each thing that a person may turn to next, by its first tool.

    A goal that stays over a thing pulls back a person who has arrived and goes down to stab it. So the goal
    of the present step's thing is the person's present waypoint; that of another thing is where its next step
    ends. What has no step left, and a goal that is none of the scene's ``things``, stay.
    """

    def __init__(
        self, robot: Robot, goals: Sequence[Goal], steps: Sequence[TaskStep], things: Sequence[str]
    ) -> None:
        self._robot = robot
        self._names = [goal.name if goal.name in things else None for goal in goals]
        self._poses = [goal.pose for goal in goals]
        self._steps = tuple(steps)
        self._thing = steps[0].thing if steps else ""
        self._configurations = np.array([goal.configuration for goal in goals])

    def look(
        self, done: int, step: TaskStep | None, waypoint: Waypoint | None, state: SceneState, q: FloatArray
    ) -> GoalMove | None:
        """The change since the last look, or None; ``step`` is None where nothing is left to do.

        At most one goal is solved for, which takes some 2 ms: near ``q`` (n,), rad, where the arm is. One
        that the arm cannot reach stays.
        """
        if not self._poses or step is None:
            return None
        anew, self._thing = step.thing != self._thing, step.thing
        before = self._configurations
        # The person's present goal first: others can wait.
        for index, name in sorted(enumerate(self._names), key=lambda one: one[1] != step.thing):
            at = waypoint if name == step.thing else self._next(done, name)
            if name is not None and at is not None and _apart(self._poses[index], pose := at.pose(state)):
                self._move(index, pose, q)
                break
        if anew or self._configurations is not before:
            return GoalMove(self._configurations, anew)
        return None

    def _move(self, index: int, pose: Pose, q: FloatArray) -> None:
        self._poses[index] = pose
        try:
            configuration = solve(self._robot, pose, q, steps=STEPS)
        except UserError:
            return  # out of reach: the goal stays
        self._configurations = self._configurations.copy()
        self._configurations[index] = configuration

    def _next(self, done: int, name: str | None) -> Waypoint | None:
        return next((step.waypoints[-1] for step in self._steps[done:] if step.thing == name), None)


def _apart(one: Pose, other: Pose) -> bool:
    return bool(
        np.linalg.norm(one.position - other.position) > MOVED_M
        or angle_between(one.rotation, other.rotation) > MOVED_RAD
    )
