"""One simulated drive: a simulated operator, a controller, Algorithm 1 with its safety filters, an arm."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from latentarm.arms.catalogue import DEFAULT_ARM, make_simulated_arm
from latentarm.arms.contract import check_arm
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input, Pose, StepRecord
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.place import surroundings_of
from latentarm.tasks.task import GripperTask, Task, check_not_done
from latentarm_research.metrics.drives import Drive, GoalDrive, measure_goal_drive
from latentarm_research.metrics.ending import Ending, why_it_ended
from latentarm_research.people.loop_limits import LoopLimits
from latentarm_research.people.person import Person, SimulatedPerson

RATE_HZ = 100.0
"""Rate of the simulated loop, the most that a real arm is sent from Python."""

STATE_NOISE_RAD = 0.05
"""A driven arm leaves the demonstrated states: with this noise in training the decoder has been there."""

BELIEF_PERIOD_S = 0.1
"""How often the belief is updated: as often as the simulated operator decides."""


@dataclass(frozen=True, eq=False)
class Setup:
    """Everything that stays the same from drive to drive.

    Attributes:
        task: the robot, the goals and when they are reached.
        controller: what the simulated operator steers with.
        assistance: how the robot helps towards its belief over the task's goals; None never helps.
        person: the simulated person who drives.
        time_limit_s: a drive that lasts longer has failed.
        rule: how inputs change the belief; without help too, for a decoder may look at it.
        arm: what moves, a simulated arm of `latentarm.arms.catalogue`.
    """

    task: Task
    controller: Controller
    assistance: AssistanceRule | None
    person: Person
    time_limit_s: float
    rule: Rule = BoltzmannBelief
    arm: str = DEFAULT_ARM


@dataclass(frozen=True, eq=False)
class Trace:
    """What is kept of a drive for figures, sampled at the loop's rate.

    Attributes:
        measured: its figures.
        goal: index of the goal.
        progress: share of the waypoints that were reached.
        ending: why it ended.
        time_s: (T,), s.
        position: (T, 3), the tool, m.
        input: (T, d).
        mode: (T,), index of the controller's mode.
        belief: (T, G).
    """

    measured: GoalDrive
    goal: int
    progress: float
    ending: Ending
    time_s: FloatArray
    position: FloatArray
    input: FloatArray
    mode: FloatArray
    belief: FloatArray

    @property
    def figures(self) -> Drive:
        """Those that every drive has."""
        return self.measured.drive


def simulate(
    setup: Setup,
    goal: int,
    manner: str,
    rng: np.random.Generator,
    watch: Callable[[StepRecord], None] | None = None,
) -> Trace:
    """Drive once, until the task is done or the time is over.

    Args:
        setup: who drives what, and how.
        goal: index into the task's goals.
        manner: what is done at the goal.
        rng: of the start and of the simulated operator.
        watch: is told every step, such as a recorder.

    Returns:
        The drive.

    Raises:
        UserError: the task is done where the arm starts, or the arm cannot be used.
    """
    task, controller = setup.task, setup.controller
    dt_s = 1.0 / RATE_HZ
    start = task.sample_start(goal, rng)
    clock = SimulatedClock()
    step = _step(setup, dt_s)
    operator = SimulatedPerson(task.robot, setup.person, dt_s, LoopLimits(step.dead_zone, step.joint_speed))
    remaining = list(task.waypoints(goal, manner))
    asks = task.asks(goal, manner) if isinstance(task, GripperTask) else ()
    since_s = 0.0
    check_not_done(task, start, remaining)
    with make_simulated_arm(setup.arm, task.robot, start, clock.now_s) as arm:
        check_arm(arm.spec, task.robot)
        reading = arm.read()
        step.reset(reading.q)
        records = [step(Input(np.zeros(controller.input_dim)), 0.0, reading, clock.now_s())]
        arm.enable()
        step.enable()
        for tick in range(1, int(setup.time_limit_s * RATE_HZ) + 1):
            clock.wait_until(tick * dt_s)
            reading = arm.read()
            pose = task.robot.chain.forward(reading.q)
            while remaining and task.reached(pose, remaining[0]):
                remaining.pop(0)
                since_s = (tick - 1) * dt_s
            if not remaining:
                break
            given = operator.act(step.context(reading.q), controller, step.mode, remaining[0], rng)
            if asks:
                given = replace(given, gripper=asks[-1 - len(remaining)])
            records.append(step(given, 0.0, reading, clock.now_s()))
            if watch is not None:
                watch(records[-1])
            arm.send(records[-1].command)
    return _trace(records, setup, goal, manner, remaining, since_s)


def _step(setup: Setup, dt_s: float) -> Step:
    task = setup.task
    goals = np.stack([goal.configuration for goal in task.goals])
    return Step(
        task.robot,
        setup.controller,
        SafetyConfig(obstacles=tuple(task.obstacles)),
        goals=task.goals,
        belief=setup.rule(goals, period_s=BELIEF_PERIOD_S),
        assistance=None if setup.assistance is None else setup.assistance(goals),
        dt_s=dt_s,
        surroundings=surroundings_of(task, setup.controller.objects),
    )


def _trace(
    records: list[StepRecord], setup: Setup, goal: int, manner: str, remaining: list[Pose], since_s: float
) -> Trace:
    chain = setup.task.robot.chain
    waypoints: tuple[Pose, ...] = setup.task.waypoints(goal, manner)
    return Trace(
        measured=measure_goal_drive(
            records, chain, waypoints[-1], [goal.pose for goal in setup.task.goals], success=not remaining
        ),
        goal=goal,
        progress=1.0 - len(remaining) / len(waypoints),
        ending=why_it_ended(records, chain, remaining[0] if remaining else None, since_s),
        time_s=np.array([record.time_s for record in records]),
        position=chain.forward(np.stack([record.state for record in records])).position,
        input=np.stack([record.input for record in records]),
        mode=np.array([record.mode for record in records], dtype=np.float64),
        belief=np.stack([record.belief for record in records]),
    )
