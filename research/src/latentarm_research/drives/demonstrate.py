"""Demonstrations of a task with things: a simulated person guides the arm through its steps, in physics."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, final

import numpy as np

from latentarm.arms.catalogue import make_scene_arm
from latentarm.control.clock import SimulatedClock
from latentarm.core.parallel import run_grid
from latentarm.core.types import (
    Command,
    Demonstrations,
    Episode,
    FloatArray,
    GripperCommand,
    Pose,
    Reading,
)
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.kinematics.pose_rows import stored_rows
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.tasks.step_goals import GoalMove, StepGoals
from latentarm.tasks.steps import Progress, Waypoint
from latentarm_research.drives.guide import GuidingHand, Movement, guided

PERIOD_S: Final = 0.01
"""How often the person's hand moves on, s."""

SAMPLE_TICKS: Final = 5
"""Every so many periods a sample is kept: 20 Hz."""

HOLD_S: Final = 0.05
"""How long a command lasts, s."""

DEMONSTRATION_STREAM: Final = 11
"""Separates the demonstrations' randomness from everything else drawn from the same seed."""


@final
@dataclass(frozen=True, eq=False)
class Demonstration:
    """One run of the scripted demonstrator."""

    episode: Episode  # the recorded samples
    progress: Progress  # how far it came
    seconds: float  # how long it took, s
    states: tuple[SceneState, ...]  # how things stood at every kept sample
    objects: tuple[str, ...]  # names of the things whose poses the episode holds
    begun: Beginning  # how it began
    moves: Mapping[int, GoalMove]  # how the goals moved, by the index of the sample from which they had


def demonstrate_once(
    task: SceneTask,  # what is done
    choice: int,  # index into the task's choices
    rng: np.random.Generator,  # source of all variation
    time_limit_s: float = math.inf,  # where the task's own is longer, s
) -> Demonstration:
    """Guide an arm through one run of a task.

    Nothing but the arm itself stands between the person's hand and the joints: as in a real kinesthetic
    demonstration there is no stick, no `Step` and no safety filter.
    """
    begun = task.begin(choice, rng)
    person = _Person(task, begun, rng)
    clock = SimulatedClock()
    samples: list[tuple[Reading, Command]] = []
    states: list[SceneState] = []
    goals = StepGoals(task.robot, begun.goals, begun.steps, begun.scene.names)
    moves: dict[int, GoalMove] = {}
    with make_scene_arm("mujoco", task.robot, begun.state, clock.now_s, begun.scene) as driven:
        driven.enable()
        for tick in range(int(min(task.time_limit_s, time_limit_s) / PERIOD_S)):
            clock.wait_until(tick * PERIOD_S)
            state, reading = driven.scene_state(), driven.read()
            person.progress.update(state)
            command = person.command(state, reading, clock.now_s())
            if tick % SAMPLE_TICKS == 0:
                progress = person.progress
                move = goals.look(progress.done, progress.step, progress.waypoint, state, reading.q)
                if move is not None:
                    moves[len(samples)] = move
                samples.append((reading, command))
                states.append(state)
            if person.progress.step is None or person.progress.failure is not None:
                break
            driven.send(command)
    episode = _episode(begun, samples, states)
    took_s, seen = clock.now_s(), tuple(states)
    return Demonstration(episode, person.progress, took_s, seen, begun.objects, begun, moves)


def demonstrate(
    task: SceneTask, episodes: int, seed: int, jobs: int = 1, *, bars: bool = False
) -> tuple[Demonstrations, list[Demonstration]]:
    """Demonstrations of a task, its choices in turn: the dataset of those that succeeded, and all."""
    all_of_them = run_grid(
        partial(_demonstrate, task, seed),
        range(episodes),
        jobs=jobs,
        label=lambda index: f"demonstration {index + 1} of {task.name}",
        bars=bars,
        unit="demonstrations",
    )
    succeeded = [one.episode for one in all_of_them if one.progress.succeeded]
    return dataset_of(task, succeeded, all_of_them[0].objects), all_of_them


def dataset_of(task: SceneTask, episodes: Sequence[Episode], objects: tuple[str, ...]) -> Demonstrations:
    """Demonstrations of a task as a dataset."""
    robot = task.robot
    return Demonstrations(
        episodes=tuple(episodes),
        rate_hz=1.0 / (PERIOD_S * SAMPLE_TICKS),
        joint_names=robot.joint_names,
        robot=robot.name,
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
        objects=objects,
    )


def _demonstrate(task: SceneTask, seed: int, index: int) -> Demonstration:
    rng = np.random.default_rng([DEMONSTRATION_STREAM, seed, index])
    return demonstrate_once(task, index % len(task.choices), rng)


@final
class _Person:
    """Decides where the tool is meant to be, movement by movement."""

    def __init__(self, task: SceneTask, begun: Beginning, rng: np.random.Generator) -> None:
        self.progress = Progress(begun.steps, begun.failures)
        self._robot = task.robot
        self._hand = GuidingHand()
        self._rng = rng
        self._movement: Movement | None = None
        self._began_s = 0.0
        self._waypoint: Waypoint | None = None
        self._meant: Pose | None = None
        self._gripper: GripperCommand | None = None

    def command(self, state: SceneState, reading: Reading, now_s: float) -> Command:
        """What the arm does until the next period."""
        waypoint = self.progress.waypoint
        meant = self._meant or state.tool
        if waypoint is not None:
            self._aim(waypoint, meant, state, now_s)
        ahead = meant
        if self._movement is not None:
            ahead = self._movement.at(now_s + PERIOD_S - self._began_s)
        velocity = guided(self._robot, reading.q, meant, ahead, PERIOD_S, self._hand)
        self._meant = ahead
        self._squeeze()
        return Command(velocity, HOLD_S, gripper=self._gripper)

    def _aim(self, waypoint: Waypoint, meant: Pose, state: SceneState, now_s: float) -> None:
        """Begin a movement where there is a new waypoint, or the last one fell short of it."""
        over = self._movement is None or now_s - self._began_s >= self._movement.duration_s
        if waypoint is self._waypoint and (self.progress.waits or not over):
            return
        self._movement = Movement(meant, waypoint.pose(state), self._hand, waypoint.speed, self._rng)
        self._began_s, self._waypoint = now_s, waypoint

    def _squeeze(self) -> None:
        gripper, asked = self._robot.gripper, self.progress.asks
        if gripper is not None and asked is not None:
            width_m = gripper.width_m if asked == "open" else 0.0
            self._gripper = GripperCommand(width_m, gripper.speed_m_s, GRASP_N)


GRASP_N: Final = 20.0
"""How hard the person lets the fingers press, N."""


def _episode(begun: Beginning, samples: list[tuple[Reading, Command]], states: list[SceneState]) -> Episode:
    extras: dict[str, FloatArray] = {}
    if begun.objects:
        extras[ENVIRONMENT] = np.stack(
            [np.concatenate([stored_rows(state.poses[name]) for name in begun.objects]) for state in states]
        )
    widths = [reading.gripper.width_m for reading, _ in samples if reading.gripper is not None]
    if len(widths) == len(samples):
        extras["observation.gripper_width"] = np.array(widths)[:, None]
        extras["action.gripper"] = np.array(_targets(samples, widths[0]))[:, None]
    return Episode(
        state=np.stack([reading.q for reading, _ in samples]),
        timestamp=np.arange(len(samples), dtype=np.float64) * (PERIOD_S * SAMPLE_TICKS),
        task=begun.text,
        extras=extras,
    )


def _targets(samples: list[tuple[Reading, Command]], first_m: float) -> list[float]:
    """The opening that was asked for at each sample, m: where the gripper is, until it is asked."""
    targets: list[float] = []
    for _, command in samples:
        first_m = first_m if command.gripper is None else command.gripper.width_m
        targets.append(first_m)
    return targets
