"""One run of a task, as pages follow it: its steps tick off until it has succeeded or failed."""

import math
from dataclasses import dataclass, replace
from typing import Final, final

from latentarm.arms.contract import Arm, SceneArm
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.goal_task import coming_to, without_things
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.steps import Failure, Progress, StepKind, TaskStep
from latentarm.tasks.task import Task
from latentarm.web.arm_process.fills import Fills, Vessel, vessels
from latentarm.web.arm_process.guide import Guide
from latentarm.web.protocol.report import Lost, TaskState, ToGo, Why

_FEW: Final = 2
"""Waypoints that a person can be told one by one; of a longer way only the end counts."""

_LOOK_EVERY_S: Final = 0.1
"""How often is looked what is left of the way, and how full things are: it is told in words."""


@final
@dataclass(frozen=True, eq=False)
class Todo:
    """What is to be done in a run.

    Attributes:
        task: its name.
        choices: what a person may choose to do, names of things or goals.
        choice: index of what is done in this run.
        steps: in order; empty where nothing counts as done.
        failures: what ends the run.
        vessels: what is poured from and into.
    """

    task: str
    choices: tuple[str, ...]
    choice: int
    steps: tuple[TaskStep, ...]
    failures: tuple[Failure, ...] = ()
    vessels: tuple[Vessel, ...] = ()


def things_to_do(task: SceneTask, choice: int, begun: Beginning) -> Todo:
    """What is to be done at a task with things.

    Args:
        task: the task.
        choice: index into its choices.
        begun: how the run begins.
    """
    return Todo(task.name, task.choices, choice, begun.steps, begun.failures, vessels(begun))


def goal_to_reach(task: Task, choice: int) -> Todo:
    """What is to be done at a task without things: to bring the tool to a goal, as simulated drives do.

    Args:
        task: the task; its first manner counts.
        choice: index of the goal.
    """
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

    It sees how everything stands in every tick, as simulated drives do: what has been stirred adds up, and a
    force is seen only once. That takes some 0.2 ms.

    Args:
        todo: what is to be done.
        arm: tells where things are, where it knows of any.
        chain: tells where the tool is.
    """

    def __init__(self, todo: Todo, arm: Arm, chain: Chain) -> None:
        self._todo = todo
        self._arm = arm if isinstance(arm, SceneArm) else None
        self._chain = chain
        self._progress = Progress(todo.steps, todo.failures)
        self._guide = Guide()
        self._to_go: ToGo | None = None
        self._fills = Fills(todo.vessels)
        self._looked_s = -math.inf
        self._began_s: float | None = None
        self._time_s = 0.0

    @property
    def state(self) -> TaskState:
        """How far it has come."""
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

    def see(self, time_s: float, q: FloatArray, *, enabled: bool, steered: bool) -> None:
        """Take how things stand, in every tick.

        Args:
            time_s: the clock, s.
            q: (n,), where the joints are, rad.
            enabled: whether the arm may move.
            steered: whether a person steers it. A goal that it passes on its way to a saved pose is not
                reached; what becomes of things counts always.
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
            self._looked_s = time_s
            self._to_go = self._guide.look(self._step, state)
            self._fills.see(state, time_s)

    @property
    def _step(self) -> TaskStep | None:
        """What is to be done now."""
        return None if self._progress.failure is not None else self._progress.step

    @property
    def _lost(self) -> Lost | None:
        """What is no longer held, and is to be taken again."""
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
