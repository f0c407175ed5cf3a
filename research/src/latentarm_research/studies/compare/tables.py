"""From cells to rows, over seeds, over folds and with fewer demonstrations, and the tables of these."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from rich.console import RenderableType

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.summary import Subject, summarise
from latentarm.evaluation.table import format_figure, measure_name, rich_figures
from latentarm_research.studies.compare.cell import FoldResult
from latentarm_research.studies.compare.measures import TABLES
from latentarm_research.studies.tables import grid_table

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


CORNER: Final = "mean ± SD over seeds [SD over folds]"

MM_PER_M: Final = 1e3


def in_millimetres(row: Row) -> Row:
    """A length in m as one in mm; any other figure as it is."""
    if row.unit != "m":
        return row
    mean = None if row.mean is None else MM_PER_M * row.mean
    return replace(row, unit="mm", mean=mean, sd=None if row.sd is None else MM_PER_M * row.sd)


def terminal_tables(
    rows: Sequence[Row], datasets: Sequence[str], noises_rad: Sequence[float], width: int
) -> list[RenderableType]:
    """A table per dataset, noise and kind of measure: measures down, models across."""
    return [
        rich_figures(
            *_arranged(rows, dataset, noise_rad, measures),
            corner=CORNER,
            title=f"{dataset}, {condition(noise_rad)}: {name[0].lower()}{name[1:]}",
            width=width,
        )
        for dataset in datasets
        for noise_rad in noises_rad
        for name, measures in TABLES.items()
    ]


def page_table(rows: Sequence[Row], dataset: str, noise_rad: float, of: Sequence[str]) -> str:
    """The same for a page, of some measures."""
    return _grid(CORNER, _arranged(rows, dataset, noise_rad, of)[2])


def drive_table(rows: Sequence[Row], dataset: str) -> str:
    """Drives of one dataset: measures down, controllers across."""
    here = [row for row in rows if row.task == dataset]
    figures = {
        (measure_name(row), look_of(row.model or "").label): format_figure(row.mean, row.sd) for row in here
    }
    return _grid("mean ± SD over drives", figures)


def _grid(corner: str, texts: Mapping[tuple[str, str], str]) -> str:
    """A table of texts by line and column, in the order in which they first stand there."""
    lines, columns = ({name[place]: name[place] for name in texts} for place in (0, 1))
    return grid_table(corner, lines, columns, lambda line, column: texts.get((line, column)))


def _arranged(
    rows: Sequence[Row], dataset: str, noise_rad: float, of: Sequence[str]
) -> tuple[list[str], list[str], dict[tuple[str, str], str]]:
    """Names of measures and of models, and the figure of each pair with its two SDs."""
    here = [in_millimetres(row) for row in rows if row.task == dataset and row.measure in of]
    seeds = [row for row in here if row.condition == condition(noise_rad)]
    folds = {
        (row.measure, row.model): row.sd for row in here if row.condition == condition(noise_rad, OVER_FOLDS)
    }
    figures: dict[tuple[str, str], str] = {}
    for row in seeds:
        spread = folds.get((row.measure, row.model))
        beside = "" if not spread else f" [{spread:.2g}]"
        figures[measure_name(row), look_of(row.model or "").label] = format_figure(row.mean, row.sd) + beside
    measures = list(dict.fromkeys(measure for measure, _ in figures))
    models = list(dict.fromkeys(model for _, model in figures))
    return measures, models, figures
