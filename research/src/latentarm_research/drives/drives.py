"""Many simulated drives: every choice of a task several times, the same for every controller."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.contract import Arm
from latentarm.core.parallel import run_grid
from latentarm.tasks.goal_task import GoalTask
from latentarm_research.drives.drive import Record, Setup, drive
from latentarm_research.drives.trace import Trace

AT_GOALS: Final = 2
WITH_THINGS: Final = 12
"""Separate the drives' randomness from everything else drawn from the same seed."""


@final
@dataclass(frozen=True, eq=False)
class Planned:
    """A drive before it is driven. Driven again, it is the same to the bit.

    Its randomness depends on the seed, the choice and its number alone, so that every controller meets the
    same starts and things, and the number of processes changes nothing.
    """

    setup: Setup  # who drives what
    choice: int  # index into the task's choices
    repeat: int  # number of the drive for this choice
    seed: int  # of the start, of the things' places and of the simulated operator

    def drive(self, watch: Callable[[Arm], None] | None = None, record: Record | None = None) -> Trace:
        """Drive; see `latentarm_research.drives.drive.drive`."""
        stream = AT_GOALS if isinstance(self.setup.task, GoalTask) else WITH_THINGS
        rng = np.random.default_rng([stream, self.seed, self.choice, self.repeat])
        return drive(self.setup, self.choice, rng, watch, record)


def plan_drives(setups: Sequence[Sequence[Setup]], drives: int, seed: int) -> list[Planned]:
    """Drives of one condition, choice by choice.

    Args:
        setups: of one task, a list for each of its manners. Manners take turns among the drives for a choice,
            and the setups of a manner among all drives, so that no figure depends on one trained model.
        drives: for each choice.
        seed: of the starts, of the things' places and of the simulated operator.
    """
    planned: list[Planned] = []
    for index in range(drives * len(setups[0][0].task.choices)):
        choice, repeat = divmod(index, drives)
        turn = setups[repeat % len(setups)]
        planned.append(Planned(turn[index % len(turn)], choice, repeat, seed))
    return planned


def drive_all(conditions: Sequence[Sequence[Planned]], jobs: int, *, bars: bool = False) -> list[list[Trace]]:
    """Drive in each condition, processes side by side."""
    traces = iter(
        run_grid(
            Planned.drive,
            [planned for condition in conditions for planned in condition],
            jobs=jobs,
            label=lambda planned: f"the drive for the {planned.setup.task.choices[planned.choice]}",
            bars=bars,
            unit="drives",
        )
    )
    return [[next(traces) for _ in condition] for condition in conditions]
