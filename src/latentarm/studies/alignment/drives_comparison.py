"""Figures of the drives, and tests of what alignment does for them.

All Priors is compared with No Align and with No Priors, drive by drive: each pair has the same model, goal,
start and chances. Whether the goal is reached is tested by McNemar's exact test, the time by a paired t test;
both are one-sided, and corrected by Holm's method over all tests with one kind of model.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.metrics.summary import Subject, summarise
from latentarm.studies.alignment.conditions import ALL_PRIORS, NO_ALIGN, WITHOUT_PRIORS
from latentarm.studies.alignment.drives import DRIVEN, DrivesResult
from latentarm.studies.alignment.drives_learning import TASK
from latentarm.studies.hypotheses import Comparison, corrected
from latentarm.studies.statistics import Statistic, paired
from latentarm.tasks.table_top import TableTop
from latentarm.types import FloatArray, Row

REACHED: Final = "arrival_rate"
TIME: Final = "time_s"
DONE: Final = "success_rate"
ERROR: Final = "relative_alignment_error"


def drive_figures(result: DrivesResult, condition: str) -> dict[str, FloatArray]:
    """Figures (P,) of all drives of a condition.

    ``arrival_rate``: whether the tool came to the goal; ``time_s``: until then, all the time there was where
    it never did; ``success_rate``: whether it was stabbed or scooped there, too.
    """
    drives, limit_s = result.drives[condition], result.cell.preset.drives.limit_s
    return {
        REACHED: np.array([float(one.reached_s is not None) for one in drives]),
        TIME: np.array([limit_s if one.reached_s is None else one.reached_s for one in drives]),
        DONE: np.array([float(one.done) for one in drives]),
    }


def misses(result: DrivesResult, condition: str) -> FloatArray:
    """Where the drives (F,) that never came to their goal left the tool, (F, 2), m.

    How far from the goal along the person's two directions, and how far across them.
    """
    goals = TableTop().goals
    missed = [one for one in result.drives[condition] if one.reached_s is None]
    off = np.array([one.path[-1] - goals[one.goal].pose.position for one in missed]).reshape(-1, 3)
    along = off @ result.directions.T
    across = off - along @ result.directions
    return np.stack([np.linalg.norm(along, axis=1), np.linalg.norm(across, axis=1)], axis=1)


def drives_rows(results: Sequence[DrivesResult]) -> list[Row]:
    """Mean and SD of every figure: of drives over drives, of alignments over models."""
    rows: list[Row] = []
    for result in results:
        for condition in DRIVEN:
            subject = Subject("alignment", TASK, result.cell.model, condition)
            if condition in result.errors:
                rows.append(summarise(subject, ERROR, result.errors[condition]))
            rows += [
                summarise(subject, name, values) for name, values in drive_figures(result, condition).items()
            ]
    return rows


def compare_drives(results: Sequence[DrivesResult]) -> list[Comparison]:
    """Every test, model by model."""
    comparisons: list[Comparison] = []
    for result in results:
        figures = {name: drive_figures(result, name) for name in (ALL_PRIORS, NO_ALIGN, WITHOUT_PRIORS)}
        comparisons += [
            _test(
                result.cell.model, measure, against, figures[ALL_PRIORS][measure], figures[against][measure]
            )
            for measure in (REACHED, TIME)
            for against in (NO_ALIGN, WITHOUT_PRIORS)
        ]
    return corrected(comparisons)


def _test(model: str, measure: str, against: str, own: FloatArray, other: FloatArray) -> Comparison:
    """One test, without correction."""
    more = measure == REACHED
    return Comparison(
        hypothesis="drives",
        family=model,
        task=TASK,
        model=model,
        measure=measure,
        subject=ALL_PRIORS,
        against=against,
        direction="greater" if more else "less",
        mean=float(own.mean()),
        mean_against=float(other.mean()),
        n=len(own),
        n_against=len(other),
    ).tested(_mcnemar(own, other) if more else paired(own, other, "less"))


def _mcnemar(own: FloatArray, other: FloatArray) -> Statistic:
    """Whether more drives reach the goal: p of those that differ, by the binomial distribution."""
    from scipy.stats import binomtest  # takes a second, and only a finished study needs it

    better, worse = int((own > other).sum()), int((own < other).sum())
    if better + worse == 0:
        return Statistic("none: no drive differs")
    return Statistic("McNemar", p=float(binomtest(better, better + worse, alternative="greater").pvalue))
