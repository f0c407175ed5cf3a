"""One row per simulated drive at a task with things, for ``drives.json`` and ``drives.csv``."""

from collections.abc import Sequence
from typing import Final

from latentarm_research.drives.drive_table import EVERY_DRIVE, every_drive
from latentarm_research.drives.task_drive import TaskTrace

COLUMNS: Final[dict[str, str]] = {
    "drive": "number of the drive, from 0",
    "choice": "index of what was to be done, from 0",
    "choice_name": "the same in words",
    "repeat": "number of the drive for this choice, from 0",
    "seed": "seed of the command; things, start and inputs depend on seed, choice and repeat alone",
    "controller": "latent, latent_assist, end_effector, two_sticks or retargeting",
    "operator": "greedy, learning, reading, unsteady or planning; all are simulated",
    "success": "whether all steps were done and nothing went wrong",
    "steps_done": "share of the steps that were done, 0 to 1",
    "not_done": "the first step that was not done, in words",
    "ended_in_words": "why the drive ended",
    **EVERY_DRIVE,
    "stops": "how often the arm was stopped and had to be enabled again",
    "preference_alignment": "mean dot product of where the tool points and where it should",
    "table_force_n": "largest force of the tool on the table or a dish, N",
    "food_force_n": "largest force of the tool on food, N",
    "spilled": "grains that were spilled",
    "grains": "grains that there were",
}
"""What each column of ``drives.csv`` holds at a task with things; ``drives`` in ``drives.json`` has the same
fields."""


def task_drive_entries(
    choices: Sequence[str],
    traces: Sequence[TaskTrace],
    *,
    drives: int,
    seed: int,
    controller: str,
    operator: str,
) -> list[dict[str, object]]:
    """One mapping per drive, with the keys of `COLUMNS` in that order.

    Args:
        choices: of the task, in words.
        traces: what came of the drives, choice by choice.
        drives: for each choice.
        seed: of the command.
        controller: what drove.
        operator: who gave inputs.
    """
    return [
        {
            "drive": number,
            "choice": trace.choice,
            "choice_name": choices[trace.choice],
            "repeat": number % drives,
            "seed": seed,
            "controller": controller,
            "operator": operator,
            "success": trace.figures.success,
            "steps_done": trace.measured.steps_done,
            "not_done": trace.ended_in,
            "ended_in_words": trace.why,
            **every_drive(trace.figures),
            "stops": trace.measured.stops,
            "preference_alignment": trace.measured.preference_alignment,
            "table_force_n": trace.measured.table_force_n,
            "food_force_n": trace.measured.food_force_n,
            "spilled": trace.measured.spilled,
            "grains": trace.measured.grains,
        }
        for number, trace in enumerate(traces)
    ]
