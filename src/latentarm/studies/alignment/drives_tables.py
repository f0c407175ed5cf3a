"""The tables of ``results.md`` about drives."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.metrics.measures import label_of, unit_of
from latentarm.metrics.table import ABSENT, format_figure
from latentarm.studies.alignment.conditions import ALL_PRIORS, IDEAL, NO_ALIGN, WITHOUT_PRIORS
from latentarm.studies.alignment.drives import DRIVEN, HELPED, KNOWS, DrivesResult
from latentarm.studies.alignment.drives_comparison import DONE, ERROR, REACHED, TIME, drive_figures, misses
from latentarm.studies.hypotheses import Comparison, comparison_table
from latentarm.studies.page import markdown_table
from latentarm.studies.statistics import format_p
from latentarm.types import FloatArray

WORDS: Final = {
    NO_ALIGN: "z = u",
    WITHOUT_PRIORS: "learned from the answers alone",
    ALL_PRIORS: "learned from the same answers and all priors",
    HELPED: "the same, and the arm helps towards the goals that it believes in, as in the demo",
    IDEAL: "learned from many more answers",
    KNOWS: "z = u and a person of equation 24 who knows exactly what each input does: the demo's operator",
}
"""What each condition is."""


MISSED: Final = "the others end off, along and across (mm)"


def drive_parts(
    results: Sequence[DrivesResult], tests: Sequence[Comparison]
) -> dict[str, dict[str, str | list[str]]]:
    """Per kind of model the table, what the tests come to in a sentence each, and the tests."""
    parts: dict[str, dict[str, str | list[str]]] = {}
    for result in results:
        of_model = [one for one in tests if one.model == result.cell.model]
        parts[result.cell.model] = {
            "table": _table(result),
            "said": _said(of_model),
            "tests": comparison_table(of_model),
        }
    return parts


def ways(result: DrivesResult) -> list[str]:
    """What each axis of the stick means to the person."""
    return [
        f"axis {axis} means ({', '.join(f'{part:+.2f}' for part in direction)})"
        for axis, direction in enumerate(result.directions, start=1)
    ]


def _table(result: DrivesResult) -> str:
    """Conditions down, figures across."""
    head = ["simulated", *(_name(measure) for measure in (ERROR, REACHED, TIME)), MISSED, _name(DONE)]
    return markdown_table(head, [_line(result, condition) for condition in DRIVEN])


def _name(measure: str) -> str:
    own = {REACHED: "reaches the goal", DONE: "stabs or scoops, too", TIME: "time to the goal"}
    unit = unit_of(measure)
    return own.get(measure, label_of(measure)) + ("" if unit == "1" else f" ({unit})")


def _line(result: DrivesResult, condition: str) -> list[str]:
    figures = drive_figures(result, condition)
    errors = result.errors.get(condition)
    return [
        condition,
        ABSENT if errors is None else _mean_and_sd(errors),
        _share(figures[REACHED]),
        _mean_and_sd(figures[TIME]),
        _misses(misses(result, condition)),
        _share(figures[DONE]),
    ]


def _share(happened: FloatArray) -> str:
    return f"{int(happened.sum())} of {len(happened)} ({happened.mean():.0%})"


def _misses(off_m: FloatArray) -> str:
    along, across = 1000 * off_m.mean(axis=0) if len(off_m) else (None, None)
    return ABSENT if along is None else f"{along:.0f}, {across:.0f}"


def _mean_and_sd(values: FloatArray) -> str:
    return format_figure(float(values.mean()), float(np.std(values, ddof=1)) if len(values) > 1 else None)


def _said(tests: Sequence[Comparison]) -> list[str]:
    """What the tests of one model come to, in a sentence each."""
    words = {REACHED: "reaches more goals than", TIME: "is faster than"}
    return [
        f"{ALL_PRIORS} {words[one.measure]} {one.against}: "
        + ("supported" if one.holds else f"**not supported**{_why(one)}")
        for one in tests
    ]


def _why(test: Comparison) -> str:
    return f" ({test.test.removeprefix('none: ')})" if test.p is None else f" (p = {format_p(test.p_holm)})"
