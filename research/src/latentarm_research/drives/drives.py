"""Many simulated drives: every goal several times, the same for every controller."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.core.parallel.grid import run_grid
from latentarm.tasks.task import Task
from latentarm_research.drives.drive import Setup, Trace, simulate

DRIVE_STREAM = 2
"""Separates the drives' randomness from everything else drawn from the same seed."""

DrivePlan = tuple[int, str, np.random.Generator]
"""Goal, manner and randomness of a drive."""


def drive_all(
    setups: Sequence[Setup], drives: int, seed: int, jobs: int, *, bars: bool = False
) -> list[Trace]:
    """Drive to every goal ``drives`` times, the task's manners in turn, processes side by side.

    A drive depends on the seed, the goal and its number alone, so that every controller meets the
    same starts and the number of processes changes nothing.

    Args:
        setups: on one task; they take turns, so that no figure depends on one trained model.
        drives: to each goal.
        seed: of the starts and of the simulated operator.
        jobs: processes; -1 is one per core.
        bars: show on standard error how many drives are done.

    Returns:
        The drives, goal by goal.
    """
    plan = drive_plan(setups[0].task, drives, seed)
    calls = [_Call(setups[number % len(setups)], *call) for number, call in enumerate(plan)]
    return run_grid(_simulate, calls, jobs=jobs, backend="joblib", label=_name_of, bars=bars, unit="drives")


@dataclass(frozen=True, eq=False)
class _Call:
    """One drive of `drive_all`."""

    setup: Setup
    goal: int
    manner: str
    rng: np.random.Generator


def _simulate(call: _Call) -> Trace:
    return simulate(call.setup, call.goal, call.manner, call.rng)


def _name_of(call: _Call) -> str:
    return f"the drive to {call.setup.task.goals[call.goal].name}"


def drive_plan(task: Task, drives: int, seed: int) -> list[DrivePlan]:
    """Goal, manner and randomness of every drive, goal by goal; the manners take turns.

    Args:
        task: whose goals are driven to.
        drives: to each goal.
        seed: of the starts and of the simulated operator.
    """
    return [
        (
            goal,
            task.manners[number % len(task.manners)],
            np.random.default_rng([DRIVE_STREAM, seed, goal, number]),
        )
        for goal in range(len(task.goals))
        for number in range(drives)
    ]
