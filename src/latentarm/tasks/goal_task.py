"""A task at goals as one with things: every waypoint is a step, and nothing can go wrong."""

from collections.abc import Mapping
from functools import partial
from typing import final

import numpy as np

from latentarm.core.types import Pose
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene, SceneState
from latentarm.tasks.replay import Replay
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.steps import StepKind, TaskStep, Waypoint
from latentarm.tasks.task import Task, check_not_done


@final
class GoalTask(SceneTask):
    """A task at goals, done in one of its manners, in at most ``time_limit_s``. Its choices are the goals."""

    def __init__(self, task: Task, manner: str, time_limit_s: float) -> None:
        self._task, self._manner, self.time_limit_s = task, manner, time_limit_s
        self.name, self.goals, self.obstacles = task.name, task.goals, task.obstacles
        self.choices = tuple(goal.name for goal in task.goals)

    @property
    def robot(self) -> Robot:
        return self._task.robot

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """Draw where the arm starts; UserError without such a manner, or where nothing is left to do."""
        task, manner, goal = self._task, self._manner, self._task.goals[choice].name
        start = task.sample_start(choice, rng)
        waypoints = task.waypoints(choice, manner)
        check_not_done(task, start, waypoints)
        return Beginning(
            state=start,
            scene=Scene(),
            steps=tuple(coming_to(task, "reached", goal, waypoint) for waypoint in waypoints),
            failures=(),
            goals=task.goals,
            objects=(),
            text=f"{manner} {goal}",
            asks=task.asks(choice, manner) if isinstance(task, Replay) else (),
            patient=True,
        )


def coming_to(task: Task, kind: StepKind, goal: str, waypoint: Pose) -> TaskStep:
    """The step that is done once the tool is at one of the goal's waypoints, as the task judges it."""
    done = partial(_reached, task=task, waypoint=waypoint)
    return TaskStep(kind, goal, f"{kind} the {goal}", done, (Waypoint(lambda _: waypoint),))


def without_things(tool: Pose, time_s: float, poses: Mapping[str, Pose]) -> SceneState:
    """The state of a scene where nothing can be touched; ``poses`` are of things that stay where they are."""
    return SceneState(time_s, tool, poses, {}, frozenset(), frozenset(), frozenset(), {}, {})


def _reached(state: SceneState, task: Task, waypoint: Pose) -> bool:
    return task.reached(state.tool, waypoint)
