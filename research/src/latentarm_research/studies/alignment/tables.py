"""The study's tables, and the figures and rows of its drives."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm.tasks.table_top import TableTop
from latentarm_research.studies.alignment import preset as ways
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CHOICES, CurveResult
from latentarm_research.studies.alignment.drives import DRIVEN, HELPED, KNOWS, DrivesResult
from latentarm_research.studies.alignment.drives_learning import TASK
from latentarm_research.studies.alignment.preset import CONDITIONS
from latentarm_research.studies.alignment.rows import ENCODED
from latentarm_research.studies.tables import Series, grid_table, heading, markdown_table, mean_and_sd

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


def drives_rows(result: DrivesResult) -> list[Row]:
    """Mean and SD of every figure: of drives over drives, of alignments over models."""
    rows: list[Row] = []
    for condition in DRIVEN:
        errors = {ERROR: result.errors[condition]} if condition in result.errors else {}
        figures = {**errors, **drive_figures(result, condition)}
        rows += [
            Series(TASK, ways.DRIVEN_MODEL, condition, measure, values).row("alignment")
            for measure, values in figures.items()
        ]
    return rows


WORDS: Final = {
    ways.NO_ALIGN: "z = u",
    ways.WITHOUT_PRIORS: "learned from the answers alone",
    ways.ALL_PRIORS: "learned from the same answers and all priors",
    ways.TOOL_SPACE: "learned from the same answers as `latentarm align` does",
    HELPED: "the same, with help towards the likely goals, as in the demo",
    ways.IDEAL: "learned from many more answers",
    KNOWS: "z = u and a person of equation 24 who knows exactly what each input does: the demo's operator",
}
"""Descriptions of the conditions."""


MISSED: Final = "the others end off, along and across (mm)"


def axes_in_words(result: DrivesResult) -> list[str]:
    """The meaning of each axis of the stick to the person."""
    return [
        f"axis {axis} means ({', '.join(f'{part:+.2f}' for part in direction)})"
        for axis, direction in enumerate(result.directions, start=1)
    ]


def drive_table(result: DrivesResult) -> str:
    """Conditions down, figures across."""
    names = {REACHED: "reaches the goal", TIME: "time to the goal", DONE: "stabs or scoops, too"}
    reached, time, done = (heading(measure, name) for measure, name in names.items())
    lines: list[list[str]] = []
    for condition in DRIVEN:
        figures, errors = drive_figures(result, condition), result.errors.get(condition)
        lines.append(
            [
                condition,
                ABSENT if errors is None else mean_and_sd(errors),
                _share(figures[REACHED]),
                mean_and_sd(figures[TIME]),
                _misses(misses(result, condition)),
                _share(figures[DONE]),
            ]
        )
    return markdown_table(["simulated", heading(ERROR), reached, time, MISSED, done], lines)


def _share(happened: FloatArray) -> str:
    return f"{int(happened.sum())} of {len(happened)} ({happened.mean():.0%})"


def _misses(off_m: FloatArray) -> str:
    along, across = 1000 * off_m.mean(axis=0) if len(off_m) else (None, None)
    return ABSENT if along is None else f"{along:.0f}, {across:.0f}"


CORNER = "relative error, simulated"


def condition_table(results: Sequence[AlignmentErrors]) -> str:
    """The relative errors of one task: conditions down, noises across."""

    def text(name: str, one: AlignmentErrors) -> str:
        return format_figure(one.encoded, None) if name == ENCODED else mean_and_sd(one.errors[name])

    noises = {f"noise {one.cell.noise:g}": one for one in results}
    return grid_table(CORNER, {name: name for name in (*CONDITIONS, ENCODED)}, noises, text)


def curve_table(curve: CurveResult) -> str:
    """One task and noise: numbers of answers down, choices of questions across."""

    def text(count: int, choice: str) -> str | None:
        return mean_and_sd(curve.errors[choice][count]) if count in curve.errors[choice] else None

    counts = sorted({count for errors in curve.errors.values() for count in errors})
    return grid_table(
        "answers", {str(count): count for count in counts}, {name: name for name in CHOICES}, text
    )


def stopping_table(curves: Sequence[CurveResult]) -> str:
    """Where asking stops, and the error there."""
    lines = [
        [
            look_of(one.cell.task).label,
            f"{one.cell.noise:g}",
            mean_and_sd(one.stopped_after),
            mean_and_sd(one.stopped_at),
        ]
        for one in curves
    ]
    return markdown_table(["", "noise", "answers", "relative error"], lines)
