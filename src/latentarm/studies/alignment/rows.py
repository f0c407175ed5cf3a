"""From what cells measured to the study's rows."""

from collections.abc import Iterator, Sequence
from typing import Final

from latentarm.metrics.summary import Subject, summarise
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.conditions import CONDITIONS, under
from latentarm.studies.alignment.curves import BY_NOVELTY, CurveResult
from latentarm.types import FloatArray, Row

STUDY: Final = "alignment"

ERROR: Final = "relative_alignment_error"

ANSWERS: Final = "answers"
"""How many were asked for before asking stopped."""

ENCODED: Final = "the encoder's own choice"
"""Condition of the rows that say what the encoder's own latent actions come to."""


def rows_of(results: Sequence[CellResult], curves: Sequence[CurveResult]) -> list[Row]:
    """Mean and SD over runs of every figure; the table of each task and model first, then the curves."""
    rows: list[Row] = []
    for task, model in dict.fromkeys((result.cell.task, result.cell.model) for result in results):
        here = [result for result in results if (result.cell.task, result.cell.model) == (task, model)]
        rows.append(summarise(Subject(STUDY, task, model, ENCODED), ERROR, [here[0].encoded]))
        rows += [
            summarise(Subject(STUDY, task, model, under(name, result.cell.noise)), ERROR, result.errors[name])
            for result in here
            for name in CONDITIONS
        ]
    for curve in curves:
        cell = curve.cell.learned.cell
        rows += [
            summarise(Subject(STUDY, cell.task, cell.model, condition), measure, values)
            for condition, measure, values in curve_figures(curve)
        ]
    return rows


def curve_figures(curve: CurveResult) -> Iterator[tuple[str, str, FloatArray]]:
    """Condition, measure and figures (R,) of every point of a curve, and of where asking stops."""
    noise = curve.cell.noise
    for choice, errors in curve.errors.items():
        for count, values in errors.items():
            yield under(asked(choice, count), noise), ERROR, values
    stopped = under(f"{BY_NOVELTY}, stopped", noise)
    yield stopped, ANSWERS, curve.stopped_after
    yield stopped, ERROR, curve.stopped_at


def asked(choice: str, count: int) -> str:
    """How rows name a point of a curve."""
    return f"{choice}, {count} answer{'s' * (count != 1)}"
