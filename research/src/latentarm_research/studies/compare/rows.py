"""From cells to rows: over seeds, over folds, and with fewer demonstrations."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.studies.compare.cell import FoldResult

STUDY: Final = "compare"

OVER_FOLDS: Final = "over folds"


def condition(noise_rad: float, *further: str) -> str:
    """How rows name a noise and further conditions."""
    return ", ".join([f"noise {noise_rad:g} rad", *further])


def with_demonstrations(count: int) -> str:
    """How rows name a number of demonstrations."""
    return f"{count} demonstration{'s' if count > 1 else ''}"


def rows_of(results: Sequence[FoldResult]) -> list[Row]:
    """Two rows per dataset, noise, model and measure.

    The first has mean and SD over the seeds of the mean over folds. The second, `OVER_FOLDS`, has the same
    mean and the SD over folds of the mean over seeds.
    """
    rows: list[Row] = []
    for (dataset, noise_rad, model), cells in _grouped(results).items():
        for measure, values in _stacked(cells).items():
            subject = Subject(STUDY, dataset, model, condition(noise_rad))
            rows.append(summarise(subject, measure, _mean(values, axis=0)))
            over = Subject(STUDY, dataset, model, condition(noise_rad, OVER_FOLDS))
            rows.append(summarise(over, measure, _mean(values, axis=1)))
    return rows


def rows_of_fewer(results: Sequence[FoldResult], all_of: Mapping[str, int]) -> list[Row]:
    """Mean and SD over seeds of the mean over folds, by the number of demonstrations, fewest first."""
    rows: list[Row] = []
    counts = [min(one.place.demonstrations, all_of[one.place.dataset]) for one in results]
    for count in sorted(set(counts)):
        here = [one for one, its in zip(results, counts, strict=True) if its == count]
        for (dataset, noise_rad, model), cells in _grouped(here).items():
            subject = Subject(STUDY, dataset, model, condition(noise_rad, with_demonstrations(count)))
            rows += [
                summarise(subject, measure, _mean(values, axis=0))
                for measure, values in _stacked(cells).items()
            ]
    return rows


def fit_times(results: Sequence[FoldResult]) -> dict[tuple[str, float, str], float]:
    """Dataset, noise and model -> processor time of a fit of all seeds, mean over folds, s."""
    return {
        place: float(np.mean([cell.fit_s for cell in cells])) for place, cells in _grouped(results).items()
    }


def seeds_of(results: Sequence[FoldResult]) -> list[dict[str, object]]:
    """Every figure of every seed."""
    return [
        {
            "dataset": one.place.dataset,
            "noise_rad": one.place.noise_rad,
            "model": one.place.model,
            "fold": one.place.fold,
            "demonstrations": one.place.demonstrations,
            "measure": measure,
            "values": [value if math.isfinite(value) else None for value in values.tolist()],
        }
        for one in results
        for measure, values in one.figures.items()
    ]


def _grouped(results: Sequence[FoldResult]) -> Mapping[tuple[str, float, str], list[FoldResult]]:
    groups: dict[tuple[str, float, str], list[FoldResult]] = {}
    for one in results:
        groups.setdefault((one.place.dataset, one.place.noise_rad, one.place.model), []).append(one)
    return groups


def _stacked(cells: Sequence[FoldResult]) -> dict[str, FloatArray]:
    """Measure -> (folds, seeds)."""
    return {measure: np.stack([cell.figures[measure] for cell in cells]) for measure in cells[0].figures}


def _mean(values: FloatArray, axis: int) -> FloatArray:
    """Mean without missing figures; NaN if all are missing."""
    known = np.isfinite(values)
    count = known.sum(axis=axis)
    total = np.where(known, values, 0.0).sum(axis=axis)
    return np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
