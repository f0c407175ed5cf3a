"""The comparison's tables, for the terminal and for the page."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from rich.console import RenderableType

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name, rich_figures
from latentarm_research.studies.compare.measures import TABLES
from latentarm_research.studies.compare.rows import OVER_FOLDS, condition
from latentarm_research.studies.compare.targets import TargetVerdict
from latentarm_research.studies.tables import markdown_table

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
    measures, models, figures = _arranged(rows, dataset, noise_rad, of)
    lines = [[measure, *(figures.get((measure, model), ABSENT) for model in models)] for measure in measures]
    return markdown_table([CORNER, *models], lines)


def target_table(verdicts: Sequence[TargetVerdict]) -> str:
    """Targets down, datasets and noises across."""
    columns = list(dict.fromkeys((one.dataset, one.noise_rad) for one in verdicts))
    head = ["", *(f"{dataset}, {noise_rad:g} rad" for dataset, noise_rad in columns)]
    said = {
        (one.target, one.dataset, one.noise_rad): f"{'met' if one.met else '**missed**'}: {one.said}"
        for one in verdicts
    }
    lines = [
        [target, *(said.get((target, *column), ABSENT) for column in columns)]
        for target in dict.fromkeys(one.target for one in verdicts)
    ]
    return markdown_table(head, lines)


def drive_table(rows: Sequence[Row], dataset: str) -> str:
    """Drives of one dataset: measures down, controllers across."""
    here = [row for row in rows if row.task == dataset]
    controllers = list(dict.fromkeys(row.model or "" for row in here))
    figures = {(measure_name(row), row.model): format_figure(row.mean, row.sd) for row in here}
    lines = [
        [measure, *(figures.get((measure, controller), ABSENT) for controller in controllers)]
        for measure in dict.fromkeys(measure_name(row) for row in here)
    ]
    return markdown_table(["mean ± SD over drives", *(look_of(name).label for name in controllers)], lines)


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
