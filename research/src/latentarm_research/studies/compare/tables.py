"""The comparison's tables, for the terminal and for the page."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from rich.console import RenderableType

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure, measure_name, rich_figures
from latentarm_research.studies.compare.measures import TABLES
from latentarm_research.studies.compare.rows import OVER_FOLDS, condition
from latentarm_research.studies.tables import grid_table
from latentarm_research.studies.targets import Target

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


def target_table(found: Sequence[Target]) -> str:
    """Targets down, datasets and noises across."""
    words = {True: "met", False: "**missed**"}
    return _grid("", {(one.name, one.where[0]): f"{words[one.met]}: {one.figures}" for one in found})


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
