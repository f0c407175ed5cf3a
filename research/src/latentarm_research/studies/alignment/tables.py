"""The study's series and tables."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.evaluation.table import format_figure
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.preset import CONDITIONS, PAPER_MODEL, under
from latentarm_research.studies.tables import Series, grid_table, mean_and_sd

ERROR: Final = "relative_alignment_error"

ENCODED: Final = "the encoder's own choice"
"""Condition of the rows that say what the encoder's own latent actions come to."""

CORNER: Final = "relative error, simulated"


def with_curves(results: Sequence[AlignmentErrors]) -> list[AlignmentErrors]:
    """Those that have curves, by noise and task."""
    return sorted((one for one in results if one.curves), key=lambda one: one.cell.noise)


def series_of(results: Sequence[AlignmentErrors]) -> list[Series]:
    """The errors of every run: the tables, then the curves."""
    found: list[Series] = []
    for task in dict.fromkeys(one.cell.task for one in results):
        here = [one for one in results if one.cell.task == task]
        found.append(Series(task, PAPER_MODEL, ENCODED, ERROR, np.array([here[0].encoded])))
        found += [
            Series(task, PAPER_MODEL, under(name, one.cell.noise), ERROR, one.errors[name])
            for one in here
            for name in CONDITIONS
        ]
    for one in with_curves(results):
        found += [
            Series(one.cell.task, PAPER_MODEL, under(_asked(choice, count), one.cell.noise), ERROR, values)
            for choice, errors in one.curves.items()
            for count, values in errors.items()
        ]
    return found


def _asked(choice: str, count: int) -> str:
    """The name of a point of a curve in rows."""
    return f"{choice}, {count} answer{'s' * (count != 1)}"


def condition_table(results: Sequence[AlignmentErrors]) -> str:
    """The relative errors of one task: conditions down, noises across."""

    def text(name: str, one: AlignmentErrors) -> str:
        return format_figure(one.encoded, None) if name == ENCODED else mean_and_sd(one.errors[name])

    noises = {f"noise {one.cell.noise:g}": one for one in results}
    return grid_table(CORNER, {name: name for name in (*CONDITIONS, ENCODED)}, noises, text)


def curve_table(one: AlignmentErrors) -> str:
    """One task and noise: numbers of answers down, choices of questions across."""

    def text(count: int, choice: str) -> str | None:
        return mean_and_sd(one.curves[choice][count]) if count in one.curves[choice] else None

    counts = sorted({count for errors in one.curves.values() for count in errors})
    return grid_table(
        "answers", {str(count): count for count in counts}, {name: name for name in one.curves}, text
    )
