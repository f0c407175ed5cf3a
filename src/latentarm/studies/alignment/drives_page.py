"""The section of ``results.md`` about drives."""

from collections.abc import Sequence
from math import degrees
from typing import Final

import numpy as np

from latentarm.metrics.looks import look_of
from latentarm.metrics.measures import label_of, unit_of
from latentarm.metrics.table import ABSENT, format_figure
from latentarm.studies.alignment.conditions import ALL_PRIORS, IDEAL, NO_ALIGN, WITHOUT_PRIORS
from latentarm.studies.alignment.drives import DRIVEN, HELPED, KNOWS, DrivesResult
from latentarm.studies.alignment.drives_comparison import (
    DONE,
    ERROR,
    REACHED,
    TIME,
    DriveComparison,
    drive_figures,
    misses,
)
from latentarm.studies.alignment.drives_learning import TURN_RAD
from latentarm.studies.page import listed, markdown_table
from latentarm.studies.statistics import LEVEL, format_p
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.tolerance import REACHED_ANGLE, REACHED_DISTANCE
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


def drives_section(results: Sequence[DrivesResult], tests: Sequence[DriveComparison]) -> str:
    """What was driven, how it went, and what the tests say, as Markdown.

    Args:
        results: one for each kind of model.
        tests: see `compare_drives`.
    """
    parts = ["## Drives to the goals of the demo\n", _introduction(results[0])]
    for result in results:
        of_model = [one for one in tests if one.model == result.cell.model]
        parts += [
            f"### {look_of(result.cell.model).label}\n",
            _table(result),
            _said(of_model),
            f"{_tests(of_model)}",
        ]
    parts.append(_reading(results[0]))
    return "\n".join(parts)


def _introduction(result: DrivesResult) -> str:
    """What was done, in numbers."""
    sizes, preset = result.cell.preset.drives, result.cell.preset
    goals = [goal.name for goal in TableTop().goals]
    ways = listed(_way(axis, way) for axis, way in enumerate(result.directions, start=1))
    conditions = "\n".join(f"- **{name}**: {WORDS[name]}." for name in DRIVEN)
    return f"""A **simulated** person drives a simulated Panda to {listed(goals)} on the demo's table,
and then stabs or scoops. A goal is reached within {1000 * REACHED_DISTANCE:g} mm and
{degrees(REACHED_ANGLE):.0f} degrees; a drive lasts {sizes.limit_s:g} s at most.

The person expects each axis of the stick to move the tool straight along one direction: the two in which the
demonstrated tool moves most, on a stick turned by {degrees(TURN_RAD):.0f} degrees and mirrored. So
{ways} (x ahead, y to the left, z up;
{result.speed_m_s:.2f} m/s at a full push). They answer {sizes.answers} questions by that expectation,
drawn and chosen as `latentarm align` does, and choose every input by it as equation 24 has it. They know
nothing of the decoder, the alignment and the arm.

{conditions}

{sizes.episodes} demonstrations; models of each kind: {sizes.seeds}; drives to each goal in each condition:
{sizes.to_each_goal}; answers of Ideal Align: {preset.ideal_answers}. Starts and the person's chances are the
same in every condition.
"""


def _way(axis: int, direction: FloatArray) -> str:
    return f"axis {axis} means ({', '.join(f'{part:+.2f}' for part in direction)})"


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


def _said(tests: Sequence[DriveComparison]) -> str:
    """What the tests of one model come to, in a sentence each."""
    words = {REACHED: "reaches more goals than", TIME: "is faster than"}
    lines = [
        f"- {ALL_PRIORS} {words[one.measure]} {one.against}: "
        + ("supported" if one.holds else f"**not supported**{_why(one)}")
        + "."
        for one in tests
    ]
    return "\n".join(lines) + "\n"


def _why(test: DriveComparison) -> str:
    return f" ({test.test.removeprefix('none: ')})" if test.p is None else f" (p = {format_p(test.p_holm)})"


def _tests(tests: Sequence[DriveComparison]) -> str:
    head = ["", "against", "test", "pairs", ALL_PRIORS, "other", "p, Holm"]
    lines = [
        [
            _name(one.measure),
            one.against,
            one.test,
            str(one.n),
            f"{one.mean:.3g}",
            f"{one.mean_against:.3g}",
            format_p(one.p_holm),
        ]
        for one in tests
    ]
    return f"<details><summary>Tests</summary>\n\n{markdown_table(head, lines)}\n</details>\n"


def _reading(result: DrivesResult) -> str:
    limit_s = result.cell.preset.drives.limit_s
    return f"""### How to read this

- *Relative alignment error* is over the models, on motions of demonstrations that trained nothing; the other
  figures are over drives. *Time to the goal* counts {limit_s:g} s for a drive that never gets there.
- Drives that never come to their goal end *off* it: on average so far along the two directions that the
  person steers by, and so far across them. The former a better alignment could mend. The latter nobody
  steers: two directions of the tool do not say where it is across them, nor how it is turned. That is left
  to the decoder, which follows the demonstrations only roughly.
- A stick that is turned and mirrored is one that is mirrored in a line, and along that line it is as before;
  the axes of z, too, come as they may. So No Align can come to a goal by luck.
- Ideal Align says what few answers cost; what it lacks of *{KNOWS}*, what not knowing the arm costs.
- Stabbing and scooping end within {1000 * REACHED_DISTANCE:g} mm of a pose below the goal. That is harder for
  the same reasons, in a scoop the tool turns, too, and the help is towards the goal above the food.
- Pairs of drives are tested one-sided, by McNemar's exact test and by a paired t test, with p corrected by
  Holm's method over the tests of one model; a test holds below {LEVEL:g}. All drives with one model share one
  alignment, so the tests speak of the alignments that were learned here, and of no others.
"""
