"""Many simulated drives at a task with things: every choice several times, the same for every controller."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.contract import SceneArm
from latentarm.parallel.grid import run_grid
from latentarm.simulation.task_drive import TaskSetup, TaskTrace, drive_task

DRIVE_STREAM: Final = 12
"""Separates the drives' randomness from everything else drawn from the same seed."""


def drive_choices(
    setups: Sequence[TaskSetup], drives: int, seed: int, jobs: int, *, bars: bool = False
) -> list[TaskTrace]:
    """Drive for every choice ``drives`` times; see `drive_conditions`.

    Args:
        setups: of one task; they take turns, so that no figure depends on one trained model.
        drives: for each choice.
        seed: of the things' places and of the simulated operator.
        jobs: processes; -1 is one per core.
        bars: show on standard error how many drives are done.

    Returns:
        The drives, choice by choice.

    Raises:
        UserError: the arm cannot be used.
    """
    return drive_conditions([setups], drives, seed, jobs, bars=bars)[0]


def drive_conditions(
    conditions: Sequence[Sequence[TaskSetup]], drives: int, seed: int, jobs: int, *, bars: bool = False
) -> list[list[TaskTrace]]:
    """Drive for every choice ``drives`` times in each condition, processes side by side.

    A drive depends on the seed, the choice and its number alone, so that every controller meets the same
    things and starts, and the number of processes changes nothing.

    Args:
        conditions: setups of one task for each; they take turns, so that no figure depends on one trained
            model.
        drives: for each choice.
        seed: of the things' places and of the simulated operator.
        jobs: processes; -1 is one per core.
        bars: show on standard error how many drives are done.

    Returns:
        The drives of each condition, choice by choice.

    Raises:
        UserError: the arm cannot be used.
    """
    choices = len(conditions[0][0].task.choices)
    calls = [
        _Call(setups[number % len(setups)], choice, seed, number)
        for setups in conditions
        for choice in range(choices)
        for number in range(drives)
    ]
    traces = run_grid(_drive, calls, jobs=jobs, backend="joblib", label=_name_of, bars=bars, unit="drives")
    each = choices * drives
    return [traces[first : first + each] for first in range(0, len(traces), each)]


def drive_again(
    setups: Sequence[TaskSetup], drives: int, seed: int, index: int, watch: Callable[[SceneArm], None]
) -> TaskTrace:
    """One drive of `drive_choices` once more, the same to the bit, for a camera.

    Args:
        setups: as there.
        drives: as there.
        seed: as there.
        index: of the drive among those that came of it.
        watch: sees the arm at every tick.

    Raises:
        UserError: the arm cannot be used.
    """
    choice, number = divmod(index, drives)
    return drive_task(setups[number % len(setups)], choice, _generator(seed, choice, number), watch)


@final
@dataclass(frozen=True, eq=False)
class _Call:
    """One drive of `drive_choices`."""

    setup: TaskSetup
    choice: int
    seed: int
    number: int


def _drive(call: _Call) -> TaskTrace:
    return drive_task(call.setup, call.choice, _generator(call.seed, call.choice, call.number))


def _generator(seed: int, choice: int, number: int) -> np.random.Generator:
    return np.random.default_rng([DRIVE_STREAM, seed, choice, number])


def _name_of(call: _Call) -> str:
    return f"the drive for the {call.setup.task.choices[call.choice]}"
