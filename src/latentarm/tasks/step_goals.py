"""The goals of Algorithm 1 at the steps of a task: they move on as the person does."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Goal, Pose
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.steps import TaskStep, Waypoint


@final
@dataclass(frozen=True, eq=False)
class GoalMove:
    """A change of the goals."""

    goals: FloatArray  # (G, n), configurations from now on, rad
    anew: bool  # whether a step at another thing begins, so that earlier inputs say nothing of the next goal


@final
class StepGoals:
    """Where the arm would be taken for each thing that a person may turn to next.

    A goal that stays over a thing pulls back a person who has arrived and goes down to stab it. So the goal
    of the present step's thing is the person's present waypoint; that of another thing is where its next
    step ends. What has no step left, and a goal that is no thing of the scene, stay.

    Configurations are those nearest to where the arm is: from far away a redundant arm would be pulled to
    another posture of the same pose, and its inputs would be judged by that.

    Args:
        robot: its first tool is meant.
        goals: at the start.
        steps: of the task, in order.
        things: names of the scene's things.
    """

    def __init__(
        self, robot: Robot, goals: Sequence[Goal], steps: Sequence[TaskStep], things: Sequence[str]
    ) -> None:
        self._robot = robot
        self._names = [goal.name if goal.name in things else "" for goal in goals]
        self._steps = tuple(steps)
        self._thing = steps[0].thing if steps else ""
        self._looks = -1
        self._configurations = np.array([goal.configuration for goal in goals])

    def look(
        self, done: int, step: TaskStep | None, waypoint: Waypoint | None, state: SceneState, q: FloatArray
    ) -> GoalMove | None:
        """The change since the last look, or None.

        One goal is solved for, which takes some 2 ms: the present one in every other look, and the others in
        turn. One that the arm cannot reach stays.

        Args:
            done: number of steps done.
            step: the present one; None where nothing is left.
            waypoint: the present one.
            state: of the scene.
            q: (n,), joint positions, rad.
        """
        if step is None:
            return None
        anew, self._thing = step.thing != self._thing, step.thing
        self._looks = 0 if anew else self._looks + 1
        present = {i: waypoint for i, name in enumerate(self._names) if name == step.thing and waypoint}
        others = {
            i: way
            for i, name in enumerate(self._names)
            if name != step.thing and (way := self._next(done, name)) is not None
        }
        turn, odd = divmod(self._looks, 2)
        asked = list((others if others and (odd or not present) else present).items())
        if not asked:
            return None
        index, at = asked[turn % len(asked)]
        self._move(index, at.pose(state), q)
        return GoalMove(self._configurations, anew)

    def _move(self, index: int, pose: Pose, q: FloatArray) -> None:
        try:
            configuration = solve(self._robot, pose, q)
        except UserError:
            return  # out of reach: the goal stays
        self._configurations = self._configurations.copy()
        self._configurations[index] = configuration

    def _next(self, done: int, name: str) -> Waypoint | None:
        return next((step.waypoints[-1] for step in self._steps[done:] if step.thing == name), None)
