"""The study's tables: ours next to the paper's."""

from collections.abc import Iterable
from typing import Final

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name
from latentarm_research.studies.properties.paper import (
    LENGTHS,
)
from latentarm_research.studies.tables import markdown_table

UNIT_NOT_STATED: Final = "†"  # marks a length of the paper, whose unit it does not state

Cells = dict[tuple[str, str], Row]  # rows by measure and model


def paper_table(rows: Iterable[Row], task: str) -> str:
    """One task: measures down, models across, each figure with the paper's where it has one."""
    cells = _cells(row for row in rows if row.task == task)
    models = list(dict.fromkeys(model for _, model in cells))
    lines = [
        [
            _name(cells, measure),
            *(_beside_paper(cells.get((measure, model))) for model in models),
        ]
        for measure in dict.fromkeys(measure for measure, _ in cells)
    ]
    return markdown_table(["mean ± SD", *(look_of(model).label for model in models)], lines)


def _cells(rows: Iterable[Row]) -> Cells:
    return {(row.measure, row.model or ""): row for row in rows}


def _name(cells: Cells, measure: str) -> str:
    """A measure's name as people read it."""
    return next(measure_name(row) for row in cells.values() if row.measure == measure)


def _figure(row: Row | None) -> str:
    return ABSENT if row is None else format_figure(row.mean, row.sd)


def _beside_paper(row: Row | None) -> str:
    """A figure and, in brackets, the paper's to as many digits as it prints."""
    if row is None:
        return ABSENT
    length = LENGTHS.get((row.task or "", row.model or "", row.measure))
    mean, sd = length or (row.paper_mean, row.paper_sd)
    if mean is None:
        return _figure(row)
    spread = "" if sd is None else f" ± {sd:.2g}"
    return f"{_figure(row)} (paper: {mean:.3g}{spread}{f' {UNIT_NOT_STATED}' if length else ''})"
