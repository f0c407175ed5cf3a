"""Many simulated drives at a task with things: every choice several times, the same for every controller."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.contract import SceneArm
from latentarm.core.parallel.grid import run_grid
from latentarm_research.drives.task_drive import Record, TaskSetup, TaskTrace, drive_task

DRIVE_STREAM: Final = 12
"""Separates the drives' randomness from everything else drawn from the same seed."""


@final
@dataclass(frozen=True, eq=False)
class Series:
    """Drives of one condition.

    Attributes:
        setups: of one task; they take turns, so that no figure depends on one trained model.
        drives: for each choice of the task.
    """

    setups: Sequence[TaskSetup]
    drives: int

    def calls(self, seed: int) -> "list[_Call]":
        """Its drives, choice by choice."""
        return [self.call(seed, index) for index in range(self.drives * len(self.setups[0].task.choices))]

    def call(self, seed: int, index: int) -> "_Call":
        """One of them."""
        choice, number = divmod(index, self.drives)
        return _Call(self.setups[index % len(self.setups)], choice, seed, number)


def drive_series(
    series: Sequence[Series], seed: int, jobs: int, *, bars: bool = False
) -> list[list[TaskTrace]]:
    """Drive for every choice several times in each condition, processes side by side.

    A drive depends on the seed, the choice and its number alone, so that every controller meets the same
    things and starts, and the number of processes changes nothing.

    Args:
        series: the conditions.
        seed: of the things' places and of the simulated operator.
        jobs: processes; -1 is one per core.
        bars: show on standard error how many drives are done.

    Returns:
        The drives of each condition, choice by choice.

    Raises:
        UserError: the arm cannot be used.
    """
    calls = [one.calls(seed) for one in series]
    traces = iter(
        run_grid(
            _drive,
            [call for of_one in calls for call in of_one],
            jobs=jobs,
            backend="joblib",
            label=_name_of,
            bars=bars,
            unit="drives",
        )
    )
    return [[next(traces) for _ in of_one] for of_one in calls]


def drive_again(
    series: Series,
    seed: int,
    index: int,
    watch: Callable[[SceneArm], None] | None = None,
    record: Record | None = None,
) -> TaskTrace:
    """One drive of `drive_series`, the same to the bit, for a camera or a recorder.

    Args:
        series: as there.
        seed: as there.
        index: of the drive among those that came of it.
        watch: see `drive_task`.
        record: see `drive_task`.

    Raises:
        UserError: the arm cannot be used.
    """
    call = series.call(seed, index)
    return drive_task(call.setup, call.choice, call.generator(), watch, record)


@final
@dataclass(frozen=True, eq=False)
class _Call:
    """One drive of a series."""

    setup: TaskSetup
    choice: int
    seed: int
    number: int

    def generator(self) -> np.random.Generator:
        """Of the things' places and of the simulated operator."""
        return np.random.default_rng([DRIVE_STREAM, self.seed, self.choice, self.number])


def _drive(call: _Call) -> TaskTrace:
    return drive_task(call.setup, call.choice, call.generator())


def _name_of(call: _Call) -> str:
    return f"the drive for the {call.setup.task.choices[call.choice]}"
