"""One run of a task for pages: its steps are ticked off until it has succeeded or failed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, final

from latentarm.arms.contract import SceneArm
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.goal_task import coming_to, without_things
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.step_goals import GoalMove, StepGoals
from latentarm.tasks.steps import Failure, Progress, StepKind, TaskStep
from latentarm.tasks.task import Task
from latentarm.web.arm_process.fill_level import FillLevels, Vessel, vessels
from latentarm.web.arm_process.waypoint_guide import WaypointGuide
from latentarm.web.protocol.report import Lost, TaskState, ToGo, Why

_FEW: Final = 2  # waypoints that a person is shown one by one; of a longer way only the end is shown
_LOOK_EVERY_S: Final = 0.1
"""How often the remaining way and the fill levels are updated, s: people read them as words."""


@final
@dataclass(frozen=True, eq=False)
class Todo:
    """The work in a run."""

    task: str  # its name
    choices: tuple[str, ...]  # names of things or goals to choose from
    choice: int  # index of the one of this run
    steps: tuple[TaskStep, ...]  # in order; empty where nothing counts as done
    failures: tuple[Failure, ...] = ()  # what ends the run
    vessels: tuple[Vessel, ...] = ()


def things_to_do(task: SceneTask, choice: int, begun: Beginning) -> Todo:
    """The work at a task with things; ``choice`` is an index into its choices."""
    return Todo(task.name, task.choices, choice, begun.steps, begun.failures, vessels(begun))


def goal_to_reach(task: Task, choice: int) -> Todo:
    """The work at a task without things: bring the tool to a goal, in the task's first manner."""
    names = tuple(goal.name for goal in task.goals)
    if not names:
        return Todo(task.name, (), choice, ())
    waypoints = task.waypoints(choice, task.manners[0])
    told = waypoints if len(waypoints) <= _FEW else waypoints[-1:]
    kinds: tuple[StepKind, ...] = ("approached", "reached")
    steps = [
        coming_to(task, kind, names[choice], waypoint)
        for kind, waypoint in zip(kinds[-len(told) :], told, strict=True)
    ]
    return Todo(task.name, names, choice, tuple(steps))


@final
class TaskRun:
    """Follows one run: from when the arm is enabled first until its outcome is known.

    It sees every tick, as simulated drives do: stirring adds up, and a force is seen only once. That takes
    some 0.2 ms. ``arm`` is None where no things are about it.
    """

    def __init__(self, todo: Todo, arm: SceneArm | None, chain: Chain) -> None:
        self._todo = todo
        self._arm = arm
        self._chain = chain
        self._progress = Progress(todo.steps, todo.failures)
        self._guide = WaypointGuide(frozenset(one.name for one in todo.vessels if one.enough is None))
        self._seen: SceneState | None = None
        self._to_go: ToGo | None = None
        self._fills = FillLevels(todo.vessels)
        self._looked_s = -math.inf
        self._began_s: float | None = None
        self._time_s = 0.0

    @property
    def state(self) -> TaskState:
        failure = self._progress.failure
        return TaskState(
            choice=self._todo.choice,
            done=self._progress.done,
            outcome="failure" if failure else "success" if self._succeeded else None,
            why=None if failure is None else Why(code=failure.kind, thing=failure.thing),
            time_s=round(self._time_s, 2),
            to_go=self._to_go,
            lost=self._lost,
            fills=self._fills.now,
            short=self._fills.short and not self._over,
        )

    def move_goals(
        self, goals: StepGoals, q: FloatArray, believed: Mapping[str, Pose] | None
    ) -> GoalMove | None:
        """How the goals moved with the steps, see `StepGoals.look`; ``q``: (n,), joint positions, rad.

        ``believed`` are poses that replace the true ones; None where nobody knows one.
        """
        if self._seen is None or self._over or believed is None:
            return None
        seen = replace(self._seen, poses={**self._seen.poses, **believed})
        return goals.look(self._progress.done, self._step, self._guide.waypoint, seen, q)

    def see(
        self, time_s: float, q: FloatArray, *, enabled: bool, steered: bool, closing_m: float | None = None
    ) -> None:
        """Update, in every tick; ``q``: (n,), joint positions, rad; ``closing_m`` as in `WaypointGuide.look`.

        A goal that the arm passes while no person steers, on its way to a saved pose, is not reached; the
        state of things counts always.
        """
        if not self._todo.steps or self._over:
            return
        looks = time_s - self._looked_s >= _LOOK_EVERY_S
        if self._began_s is None and enabled:
            self._began_s = time_s
        if self._began_s is None and not looks:
            return
        state = replace(self._scene_state(q), time_s=time_s)
        if self._began_s is not None:
            self._time_s = time_s - self._began_s
            if steered or self._arm is not None:
                self._progress.update(state)
        if looks or self._over:
            self._looked_s, self._seen = time_s, state
            self._to_go = self._guide.look(self._step, state, closing_m)
            self._fills.see(state, time_s)

    @property
    def _step(self) -> TaskStep | None:
        return None if self._progress.failure is not None else self._progress.step

    @property
    def _lost(self) -> Lost | None:
        index = self._progress.lost
        return None if index is None or self._over else Lost(thing=self._todo.steps[index].thing, step=index)

    @property
    def _over(self) -> bool:
        return self._succeeded or self._progress.failure is not None

    @property
    def _succeeded(self) -> bool:
        return bool(self._todo.steps) and self._progress.succeeded

    def _scene_state(self, q: FloatArray) -> SceneState:
        if self._arm is not None:
            return self._arm.scene_state()
        return without_things(self._chain.forward(q), self._time_s, {})
