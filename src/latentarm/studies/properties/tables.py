"""The study's tables in Markdown: ours beside the paper's, the noise sweep, the tests."""

from collections.abc import Callable, Iterable, Sequence
from typing import Final

from latentarm.metrics.table import ABSENT, format_figure, measure_name
from latentarm.studies.pages import markdown_table
from latentarm.studies.properties.hypotheses import Comparison
from latentarm.studies.properties.measures import RESOLUTION_M
from latentarm.studies.properties.paper import LENGTHS, MODELS_OF_THE_PAPER
from latentarm.studies.statistics import format_p
from latentarm.style import look_of
from latentarm.types import Row

OURS: Final = "isometric"
"""The model that is held against the best of the paper's."""

LESS_IS_BETTER: Final = frozenset(
    {
        "error_percent_of_pca",
        "noise_free_error_percent_of_pca",
        "controllability_m",
        "controllability_percent_of_pca",
        "drift",
        "reversal",
        "final_distance",
        "path_over_straight",
    }
)
MORE_IS_BETTER: Final = frozenset({"r2", "disentanglement_deg"})

UNIT_NOT_STATED: Final = "†"
"""Marks a length of the paper, whose unit it does not state."""

EQUAL: Final = 1e-9
"""Difference of two means, in the larger of them, below which they are equal but for rounding."""

SAME_THING: Final = frozenset({"noise_free_error_percent_of_pca", "controllability_percent_of_pca"})
"""Measures that, without noise, say again what another one says: they do not count twice."""

DISTANCES: Final = frozenset({"controllability_m", "final_distance"})

Cells = dict[tuple[str, str], Row]
"""Rows by measure and model."""


def paper_table(rows: Iterable[Row], task: str) -> str:
    """One task without noise: measures down, models across, each figure with the paper's where it has one.

    The last column says whether `OURS` is at least as good as the best of the paper's models, as both were
    measured here; it is absent where `OURS` was not measured.
    """
    cells = _cells(row for row in rows if row.task == task and row.condition is None)
    measures, models = _edges(cells)
    head = ["mean ± SD", *(look_of(model).label for model in models)]
    if OURS in models:
        head.append(f"{look_of(OURS).label} at least as good as the paper's best")
    lines: list[list[str]] = []
    for measure in measures:
        line = [_name(cells, measure), *(_beside_paper(cells.get((measure, model))) for model in models)]
        lines.append([*line, _as_good(cells, measure)] if OURS in models else line)
    return markdown_table(head, lines)


def noise_table(rows: Iterable[Row], task: str) -> str:
    """One task's noise sweep: measures under each noise down, models across."""
    rows = [row for row in rows if row.task == task and row.condition is not None]
    models = list(dict.fromkeys(row.model or "" for row in rows))
    conditions = list(dict.fromkeys(row.condition or "" for row in rows))
    lines: list[list[str]] = []
    for measure in dict.fromkeys(row.measure for row in rows):
        for condition in conditions:
            cells = _cells(row for row in rows if (row.measure, row.condition) == (measure, condition))
            if cells:
                figures = [_figure(cells.get((measure, model))) for model in models]
                lines.append([_name(cells, measure), condition, *figures])
    return markdown_table(["mean ± SD", "on states", *(look_of(model).label for model in models)], lines)


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Every test of the hypotheses."""
    head = ["", "task", "measure", "model", "against", "test", "t (dof)", "p, Holm", "Hedges' g", "holds"]
    return markdown_table(head, [_test_line(one) for one in comparisons])


def as_good_as_paper(rows: Iterable[Row], task: str) -> tuple[int, int]:
    """On how many of a task's measures `OURS` is at least as good as the paper's best, and of how many."""
    cells = _cells(row for row in rows if row.task == task and row.condition is None)
    said = [_as_good(cells, measure) for measure in _edges(cells)[0] if measure not in SAME_THING]
    return said.count("yes"), sum(text != ABSENT for text in said)


def _cells(rows: Iterable[Row]) -> Cells:
    return {(row.measure, row.model or ""): row for row in rows}


def _edges(cells: Cells) -> tuple[list[str], list[str]]:
    """Measures and models in order of first appearance."""
    return list(dict.fromkeys(measure for measure, _ in cells)), list(
        dict.fromkeys(model for _, model in cells)
    )


def _name(cells: Cells, measure: str) -> str:
    """A measure's name as people read it."""
    return next(measure_name(row) for row in cells.values() if row.measure == measure)


def _figure(row: Row | None) -> str:
    return ABSENT if row is None else format_figure(row.mean, row.sd)


def _beside_paper(row: Row | None) -> str:
    """A figure and, in brackets, the paper's to as many digits as it prints."""
    if row is None:
        return ABSENT
    mean, sd, mark = row.paper_mean, row.paper_sd, ""
    length = LENGTHS.get((row.task or "", row.model or "", row.measure))
    if length is not None:
        (mean, sd), mark = length, f" {UNIT_NOT_STATED}"
    if mean is None:
        return _figure(row)
    spread = "" if sd is None else f" ± {sd:g}"
    return f"{_figure(row)} (paper: {mean:.3g}{spread}{mark})"


def _as_good(cells: Cells, measure: str) -> str:
    """``yes``, or ``no`` with the paper's model that is better here, or absent where none has a figure."""
    better: Callable[[float, float], bool]
    if measure in LESS_IS_BETTER:
        better = float.__lt__
    elif measure in MORE_IS_BETTER:
        better = float.__gt__
    else:
        return ABSENT
    ours = cells.get((measure, OURS))
    others = {
        model: row.mean
        for model in MODELS_OF_THE_PAPER
        if (row := cells.get((measure, model))) is not None and row.mean is not None
    }
    if ours is None or ours.mean is None or not others:
        return ABSENT
    if measure in DISTANCES and max(ours.mean, *others.values()) < RESOLUTION_M:
        return ABSENT  # what is left is the solver's
    best = (min if measure in LESS_IS_BETTER else max)(others, key=others.__getitem__)
    near = abs(others[best] - ours.mean) <= EQUAL * max(abs(others[best]), abs(ours.mean))
    if near or not better(others[best], ours.mean):
        return "yes"
    return f"no ({look_of(best).label} {format_figure(others[best], None)})"


def _test_line(one: Comparison) -> list[str]:
    direction = {"less": "<", "greater": ">"}[one.direction]
    against = look_of(one.against).label if one.against else "threshold"
    statistic = ABSENT if one.t is None or one.dof is None else f"{one.t:.3g} ({one.dof:.3g})"
    return [
        one.hypothesis,
        one.task,
        one.measure,
        f"{look_of(one.model).label} {format_figure(one.mean, None)}",
        f"{direction} {against} {format_figure(one.mean_against, None)}",
        one.test,
        statistic,
        format_p(one.p_holm),
        ABSENT if one.hedges_g is None else f"{one.hedges_g:.3g}",
        "yes" if one.holds else "no",
    ]
