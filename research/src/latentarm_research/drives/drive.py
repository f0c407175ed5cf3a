"""One simulated drive: a simulated operator, a controller, Algorithm 1 with its safety filters, an arm.

A task at goals is driven like one with things: its waypoints are the steps (`GoalTask`), and nothing can be
touched.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.arms.catalogue import DEFAULT_ARM, PHYSICAL_ARM, make_scene_arm, make_simulated_arm
from latentarm.arms.contract import Arm, SceneArm, check_arm
from latentarm.assistance.assistance import Assistance, AssistanceRule
from latentarm.assistance.belief import BELIEF_PERIOD_S, Belief, Rule
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input, Pose, Reading, StepRecord
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.robots.scene.scene import SceneState
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.goal_task import without_things
from latentarm.tasks.place import watched
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.step_goals import StepGoals
from latentarm.tasks.steps import Progress
from latentarm_research.drives.following import Following, poses_at
from latentarm_research.drives.trace import Trace
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.person import Person, SimulatedPerson

RATE_HZ: Final = 100.0
"""Rate of the simulated loop, the most that a real arm is sent from Python."""

GOALS_EVERY: Final = round(BELIEF_PERIOD_S * RATE_HZ)
"""Ticks between two looks at where the goals are."""

REARM_S: Final = 2.0
"""After a stop the simulated person lets go, and enables the arm again so much later, s."""

Record = Callable[[Beginning], Callable[[StepRecord], None]]
"""Begins to record a drive."""


@final
@dataclass(frozen=True, eq=False)
class Setup:
    """Everything that stays the same from drive to drive."""

    task: SceneTask  # what is to be done; `GoalTask` at goals
    controller: Controller  # what the simulated operator steers with
    person: Person  # the simulated person who drives
    # how the robot helps towards its belief over the goals; None never helps
    assistance: AssistanceRule | None = None
    # what moves, a simulated arm of `latentarm.arms.catalogue`; by default `PHYSICAL_ARM` with things and
    # `DEFAULT_ARM` without
    arm: str | None = None
    # how inputs change the belief; without help too, for a decoder may look at it
    rule: Rule = BoltzmannBelief


def drive(
    setup: Setup,  # who drives what, and how
    choice: int,  # index into the task's choices
    rng: np.random.Generator,  # of the start, of the things' places and of the simulated operator
    watch: Callable[[Arm], None] | None = None,  # sees the arm at every tick, such as a camera
    # is told how the drive begins, and gives what is told every step, with where all things of the scene are,
    # in its order
    record: Record | None = None,
    time_limit_s: float = math.inf,  # where the task's own is longer, s
) -> Trace:
    """Drive once, until the task is done, has failed, or the time is over."""
    task, controller = setup.task, setup.controller
    begun = task.begin(choice, rng)
    note = None if record is None else record(begun)
    clock = SimulatedClock()
    follow = Following(begun)
    step = _step(setup, begun, follow)
    goals = StepGoals(task.robot, begun.goals, begun.steps, begun.scene.names)
    limits = LoopLimits(step.dead_zone, step.joint_speed)
    operator = SimulatedPerson(task.robot, setup.person, step.dt_s, limits)
    with _arm(setup, begun, clock) as arm:
        check_arm(arm.spec, task.robot)
        reading = arm.read()
        step.reset(reading.q)
        first = step(Input(np.zeros(controller.input_dim)), 0.0, reading, clock.now_s())
        if not begun.scene.names:
            follow.records.append(first)
        arm.enable()
        step.enable()
        rearming = _Rearming(step, follow.progress)
        for tick in range(1, int(min(task.time_limit_s, time_limit_s) * RATE_HZ) + 1):
            clock.wait_until(tick * step.dt_s)
            reading = arm.read()
            state = _state(arm, begun, task.robot.chain.forward(reading.q), clock.now_s())
            follow.sees(state)
            if watch is not None:
                watch(arm)
            if follow.ending is not None:
                break
            if tick % GOALS_EVERY == 0:
                _lead_on(step, goals, follow.progress, state, reading.q)
            if rearming.lets_go(clock.now_s()):
                operator.reset()
                given = Input(np.zeros(controller.input_dim))
            else:
                given = _given(operator, reading, state, follow.progress, step, controller, rng)
                if begun.asks:
                    given = replace(given, gripper=begun.asks[follow.progress.done])
            taken = step(given, 0.0, reading, clock.now_s())
            follow.records.append(taken)
            if note is not None:
                rows = thing_rows(state.poses, begun.scene.names)
                note(replace(taken, things=rows, sightings=np.zeros((len(rows), 2))))
            arm.send(taken.command)
    return follow.trace(choice, task.robot.chain, rearming.stops)


def _arm(setup: Setup, begun: Beginning, clock: SimulatedClock) -> Arm:
    robot = setup.task.robot
    if begun.scene.names:
        return make_scene_arm(setup.arm or PHYSICAL_ARM, robot, begun.state, clock.now_s, begun.scene)
    return make_simulated_arm(setup.arm or DEFAULT_ARM, robot, begun.state, clock.now_s)


def _state(arm: Arm, begun: Beginning, tool: Pose, time_s: float) -> SceneState:
    if begun.scene.names and isinstance(arm, SceneArm):
        return arm.scene_state()
    return without_things(tool, time_s, poses_at(begun))


def _step(setup: Setup, begun: Beginning, follow: Following) -> Step:
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


def _lead_on(step: Step, goals: StepGoals, progress: Progress, state: SceneState, q: FloatArray) -> None:
    """Move the goals to where the task's steps have got to, as the page does."""
    move = goals.look(progress.done, progress.step, progress.waypoint, state, q)
    if move is not None:
        step.move_goals(move.goals)
        if move.anew:
            step.forget()


def _given(
    operator: SimulatedPerson,
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
    """After a stop the person lets go, enables the arm again, and repeats the step."""

    def __init__(self, step: Step, progress: Progress) -> None:
        self.stops = 0
        self._step = step
        self._progress = progress
        self._since_s: float | None = None

    def lets_go(self, time_s: float) -> bool:
        """Return whether the person holds the stick at rest after a stop; enable the arm after `REARM_S`."""
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
