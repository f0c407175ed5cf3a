"""One simulated drive at a task with things, in physics: an operator, Algorithm 1, its filters, an arm."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.arms.catalogue import make_scene_arm
from latentarm.arms.contract import SceneArm, check_arm
from latentarm.assistance.assistance import Assistance, AssistanceRule
from latentarm.assistance.belief import Belief, Rule
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input, Pose, Reading, StepRecord
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.robots.scene.scene import TABLE, TOOL, Scene, SceneState
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.place import watched
from latentarm.tasks.predicates import Spilled
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.steps import Progress, TaskStep, Waypoint
from latentarm_research.drives.drive import BELIEF_PERIOD_S, RATE_HZ
from latentarm_research.metrics.drives import Drive
from latentarm_research.metrics.task_drives import (
    StepAlignment,
    TaskDrive,
    alignment_by_step,
    measure_task_drive,
    preference_alignment,
)
from latentarm_research.people.loop_limits import LoopLimits
from latentarm_research.people.operator import Operator
from latentarm_research.people.person import Person, SimulatedPerson

STUCK_S: Final = 20.0
"""A run in which the tool comes no nearer to its waypoint for so long has failed, s."""

NEARER: Final = 0.1
"""What counts as nearer, in tolerances of the waypoint."""


REARM_S: Final = 2.0
"""After a stop the simulated person lets go, and enables the arm again so much later, s."""


Record = Callable[[Beginning], Callable[[StepRecord], None]]
"""Begins to record a drive."""


@final
@dataclass(frozen=True, eq=False)
class TaskSetup:
    """Everything that stays the same from drive to drive.

    Attributes:
        task: what is to be done.
        controller: what the simulated operator steers with.
        person: the simulated person who drives.
        assistance: how the robot helps towards its belief over the goals; None never helps.
        arm: what moves, a simulated arm of the catalogue that can have things about it.
        rule: how inputs change the belief; without help too, for a decoder may look at it.
    """

    task: SceneTask
    controller: Controller
    person: Person
    assistance: AssistanceRule | None = None
    arm: str = "mujoco"
    rule: Rule = BoltzmannBelief


@final
@dataclass(frozen=True, eq=False)
class TaskTrace:
    """What is kept of a drive.

    Attributes:
        measured: its figures.
        choice: index into the task's choices.
        steps: what was to be done, in order.
        done_s: when each of the steps that were done was done, s.
        target: (3,), where the tool was to go first, m.
        why: why the drive ended, in a few words.
        time_s: (T,), s.
        position: (T, 3), the tool, m.
        input: (T, d).
        mode: (T,), index of the controller's mode.
        aligned: *Preference Alignment* in each step that was begun, in order.
        states: how things stood, ten times per second, for film.
    """

    measured: TaskDrive
    choice: int
    steps: tuple[TaskStep, ...]
    done_s: tuple[float, ...]
    target: FloatArray
    why: str
    time_s: FloatArray
    position: FloatArray
    input: FloatArray
    mode: FloatArray
    aligned: tuple[StepAlignment, ...]
    states: tuple[SceneState, ...]

    @property
    def figures(self) -> Drive:
        """Those that every drive has."""
        return self.measured.drive

    @property
    def goal(self) -> int:
        """What the drive was for, as figures colour it: the choice."""
        return self.choice

    @property
    def ended_in(self) -> str:
        """The step that was not done, in words; "" where all were."""
        done = len(self.done_s)
        return self.steps[done].name if done < len(self.steps) else ""


def drive_task(
    setup: TaskSetup,
    choice: int,
    rng: np.random.Generator,
    watch: Callable[[SceneArm], None] | None = None,
    record: Record | None = None,
) -> TaskTrace:
    """Drive once, until the task is done, has failed, or the time is over.

    Args:
        setup: who drives what.
        choice: index into the task's choices.
        rng: of the things' places and of the simulated operator.
        watch: sees the arm at every tick, such as a camera.
        record: is told how the drive begins, and gives what is told every step, with where all things of the
            scene are, in its order.

    Raises:
        UserError: the arm cannot be used.
    """
    task, controller = setup.task, setup.controller
    begun = task.begin(choice, rng)
    note = None if record is None else record(begun)
    clock = SimulatedClock()
    follow = _Watch(begun)
    step = _step(setup, begun, follow)
    limits = LoopLimits(step.dead_zone, step.joint_speed)
    operator = SimulatedPerson(task.robot, setup.person, step.dt_s, limits)
    with make_scene_arm(setup.arm, task.robot, begun.state, clock.now_s, begun.scene) as arm:
        check_arm(arm.spec, task.robot)
        reading = arm.read()
        step.reset(reading.q)
        step(Input(np.zeros(controller.input_dim)), 0.0, reading, clock.now_s())
        arm.enable()
        step.enable()
        rearming = _Rearming(step, follow.progress)
        for tick in range(1, int(task.time_limit_s * RATE_HZ) + 1):
            clock.wait_until(tick * step.dt_s)
            reading, state = arm.read(), arm.scene_state()
            follow.sees(state)
            if watch is not None:
                watch(arm)
            if follow.ended is not None:
                break
            if rearming.lets_go(clock.now_s()):
                operator.reset()
                given = Input(np.zeros(controller.input_dim))
            else:
                given = _given(operator, reading, state, follow.progress, step, controller, rng)
            taken = step(given, 0.0, reading, clock.now_s())
            follow.records.append(taken)
            if note is not None:
                note(replace(taken, things=thing_rows(state.poses, begun.scene.names)))
            arm.send(taken.command)
    return follow.trace(choice, rearming.stops)


def _step(setup: TaskSetup, begun: Beginning, follow: "_Watch") -> Step:
    belief: Belief | None = None
    assistance: Assistance | None = None
    if begun.goals:
        goals = np.stack([goal.configuration for goal in begun.goals])
        belief = setup.rule(goals, period_s=BELIEF_PERIOD_S)
        assistance = None if setup.assistance is None else setup.assistance(goals)
    return Step(
        setup.task.robot,
        setup.controller,
        SafetyConfig(obstacles=setup.task.obstacles),
        goals=begun.goals,
        belief=belief,
        assistance=assistance,
        dt_s=1.0 / RATE_HZ,
        surroundings=watched(lambda: follow.poses, setup.controller.objects),
    )


def _given(
    operator: Operator,
    reading: Reading,
    state: SceneState,
    progress: Progress,
    step: Step,
    controller: Controller,
    rng: np.random.Generator,
) -> Input:
    """The person's input: a push towards the waypoint, or rest while the gripper acts."""
    waypoint = progress.waypoint
    if waypoint is None or progress.asks is not None:
        return Input(np.zeros(controller.input_dim), gripper=progress.asks)
    carries = state.stabbed | state.gripped
    return operator.act(
        step.context(reading.q),
        controller,
        step.mode,
        waypoint.pose(state),
        rng,
        waypoint.within_m,
        waypoint.speed,
        np.array([name in carries for name in controller.objects], dtype=np.bool_),
    )


@final
class _Rearming:
    """What the person does about stops: they let go, enable the arm again, and begin the step again."""

    def __init__(self, step: Step, progress: Progress) -> None:
        self.stops = 0
        self._step = step
        self._progress = progress
        self._since_s: float | None = None

    def lets_go(self, time_s: float) -> bool:
        """Whether the arm is stopped; in the end it is enabled for the next tick."""
        if self._step.stopped is None:
            self._since_s = None
            return False
        if self._since_s is None:
            self.stops += 1
            self._since_s = time_s
        elif time_s - self._since_s >= REARM_S:
            self._step.enable()
            self._progress.again()
        return True


@final
class _Watch:
    """Follows a drive, and says when it is over."""

    def __init__(self, begun: Beginning) -> None:
        self.progress = Progress(begun.steps, begun.failures)
        self.records: list[StepRecord] = []
        self.ended: str | None = None
        self.poses: Mapping[str, Pose] = {thing.name: thing.pose for thing in begun.scene.things}
        self._begun = begun
        self._position: list[FloatArray] = []
        self._points: list[FloatArray] = []
        self._needed: list[FloatArray] = []
        self._under_way: list[int] = []
        self._states: list[SceneState] = []
        self._newest: SceneState
        self._done_s: list[float] = []
        self._force_n: dict[str, float] = {}
        self._waypoint: Waypoint | None = None
        self._nearest = np.inf
        self._nearer_s = 0.0

    def sees(self, state: SceneState) -> None:
        """Take how things stand before the next input."""
        self.poses, self._newest = state.poses, state
        self.progress.update(state)
        self._done_s += [state.time_s] * (self.progress.done - len(self._done_s))
        self._feel(state)
        if len(self._position) % 10 == 0:
            self._states.append(state)
        self._position.append(state.tool.position)
        waypoint = self.progress.waypoint
        if self.progress.failure is not None:
            self.ended = self.progress.failure.text
        elif waypoint is None:
            self.ended = "done"
        else:
            self._points.append(state.tool.rotation[:, 2])
            self._needed.append(waypoint.pose(state).rotation[:, 2])
            self._under_way.append(self.progress.done)
            if self._stuck(waypoint, state):
                self.ended = f"no nearer for {STUCK_S:g} s"

    def trace(self, choice: int, stops: int) -> TaskTrace:
        """What is kept."""
        spilled = [fails for fails in self._begun.failures if isinstance(fails, Spilled)]
        position = np.stack(self._position[: len(self.records)])
        points, needed = np.array(self._points), np.array(self._needed)
        steps = [step.name for step in self._begun.steps]
        measured = measure_task_drive(
            self.records,
            position,
            preference_alignment(points, needed),
            self._force_n,
            steps_done=self.progress.share,
            success=self.progress.succeeded,
            stops=stops,
            spilled=sum(one.count(self._newest) for one in spilled),
            grains=sum(len(one) for one in self._newest.grains.values()),
        )
        return TaskTrace(
            measured=measured,
            choice=choice,
            steps=self._begun.steps,
            done_s=tuple(self._done_s),
            target=self._begun.steps[0].waypoints[0].pose(self._states[0]).position,
            why=self.ended or "out of time",
            time_s=np.array([record.time_s for record in self.records]),
            position=position,
            input=np.stack([record.input for record in self.records]),
            mode=np.array([record.mode for record in self.records]),
            aligned=alignment_by_step(steps, np.array(self._under_way), points, needed),
            states=tuple(self._states),
        )

    def _feel(self, state: SceneState) -> None:
        for (first, second), force_n in state.force_n.items():
            if TOOL in (first, second):
                other = second if first == TOOL else first
                kind = _kind(self._begun.scene, other)
                self._force_n[kind] = max(self._force_n.get(kind, 0.0), force_n)

    def _stuck(self, waypoint: Waypoint, state: SceneState) -> bool:
        missed = waypoint.missed_by(state)
        if waypoint is not self._waypoint or missed < self._nearest - NEARER or self.progress.waits:
            self._waypoint, self._nearest, self._nearer_s = waypoint, missed, state.time_s
        return state.time_s - self._nearer_s > STUCK_S


def _kind(scene: Scene, name: str) -> str:
    """``food``, or ``table`` for the table and everything that stands on it for good, or ``thing``."""
    if name == TABLE:
        return "table"
    thing = scene.thing(name)
    if thing.food is not None:
        return "food"
    return "table" if thing.fixed else "thing"
