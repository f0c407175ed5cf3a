"""The study's tables: ours next to the paper's, and the noise sweep."""

from collections.abc import Iterable
from typing import Final

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.measures import measure_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name
from latentarm_research.studies.properties.measures import RESOLUTION_M
from latentarm_research.studies.properties.paper import (
    LENGTHS,
    MODELS_OF_THE_PAPER,
    ratio_name,
)
from latentarm_research.studies.tables import markdown_table

OURS: Final = "isometric"  # the model that is compared with the best of the paper's
UNIT_NOT_STATED: Final = "†"  # marks a length of the paper, whose unit it does not state

EQUAL: Final = 1e-9
"""Difference of two means, in the larger of them, below which they are equal but for rounding."""

SAME_THING: Final = frozenset(
    {
        "noise_free_error_percent_of_pca",
        "error_percent_of_pca",
        "controllability_percent_of_pca",
        "median_controllability_percent_of_pca",
    }
)
"""Measures that are redundant next to others, and so are not counted twice."""

DISTANCES: Final = frozenset({"controllability_m", "final_distance"})

NOT_JUDGED: Final = frozenset({"path_length", ratio_name("path_length"), ratio_name("final_distance")})
"""Measures that are redundant or mean nothing alone: an arm that stops early has a short path."""

Cells = dict[tuple[str, str], Row]  # rows by measure and model


def paper_table(rows: Iterable[Row], task: str) -> str:
    """One task without noise: measures down, models across, each figure with the paper's where it has one.

    The last column says whether `OURS` is at least as good as the best of the paper's models, as both were
    measured here; it is absent where `OURS` was not measured.
    """
    cells = _cells(row for row in rows if row.task == task and row.condition is None)
    models = list(dict.fromkeys(model for _, model in cells))
    judged = [f"{look_of(OURS).label} at least as good as the paper's best"] if OURS in models else []
    lines = [
        [
            _name(cells, measure),
            *(_beside_paper(cells.get((measure, model))) for model in models),
            *(_as_good(cells, measure) for _ in judged),
        ]
        for measure in dict.fromkeys(measure for measure, _ in cells)
    ]
    return markdown_table(["mean ± SD", *(look_of(model).label for model in models), *judged], lines)


def noise_table(rows: Iterable[Row], task: str) -> str:
    """One task's noise sweep: measures under each noise down, models across."""
    rows = [row for row in rows if row.task == task and row.condition is not None]
    models = list(dict.fromkeys(row.model or "" for row in rows))
    lines: list[list[str]] = []
    for measure, condition in dict.fromkeys((row.measure, row.condition or "") for row in rows):
        cells = _cells(row for row in rows if (row.measure, row.condition) == (measure, condition))
        figures = [_figure(cells.get((measure, model))) for model in models]
        lines.append([_name(cells, measure), condition, *figures])
    order = list(dict.fromkeys(line[0] for line in lines))
    lines.sort(key=lambda line: order.index(line[0]))
    return markdown_table(["mean ± SD", "on states", *(look_of(model).label for model in models)], lines)


def as_good_as_paper(rows: Iterable[Row], task: str) -> tuple[int, int]:
    """On how many of a task's measures `OURS` is at least as good as the paper's best, and of how many."""
    cells = _cells(row for row in rows if row.task == task and row.condition is None)
    measures = dict.fromkeys(measure for measure, _ in cells if measure not in SAME_THING)
    said = [_as_good(cells, measure) for measure in measures]
    return said.count("yes"), sum(text != ABSENT for text in said)


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


def _as_good(cells: Cells, measure: str) -> str:
    """``yes``, or ``no`` with the paper's model that is better here, or absent where none has a figure."""
    known = measure_of(measure)
    ours = cells.get((measure, OURS))
    others = {
        model: row.mean
        for model in MODELS_OF_THE_PAPER
        if (row := cells.get((measure, model))) is not None and row.mean is not None
    }
    if known is None or known.better is None or measure in NOT_JUDGED:
        return ABSENT
    if ours is None or ours.mean is None or not others:
        return ABSENT
    if measure in DISTANCES and max(ours.mean, *others.values()) < RESOLUTION_M:
        return ABSENT  # what is left is the solver's
    best = (min if known.better == "lower" else max)(others, key=others.__getitem__)
    behind = ours.mean - others[best] if known.better == "lower" else others[best] - ours.mean
    if behind <= EQUAL * max(abs(others[best]), abs(ours.mean)):
        return "yes"
    return f"no ({look_of(best).label} {format_figure(others[best], None)})"
