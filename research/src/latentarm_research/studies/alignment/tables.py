"""The study's tables: in Markdown for the page, and at a glance for a terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure, measure_name
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CHOICES, CurveResult
from latentarm_research.studies.alignment.drives import DRIVEN
from latentarm_research.studies.alignment.drives_learning import TASK
from latentarm_research.studies.alignment.drives_tables import REACHED, TIME
from latentarm_research.studies.alignment.preset import CONDITIONS, DRIVEN_MODEL, PAPER_MODEL, Preset, under
from latentarm_research.studies.alignment.rows import ENCODED, ERROR
from latentarm_research.studies.tables import grid_table, markdown_table, mean_and_sd, terminal_table

if TYPE_CHECKING:
    from rich.table import Table

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


def summary_tables(rows: Sequence[Row], preset: Preset) -> "list[Table]":
    """A table per task with the paper's model, conditions down, noises across, and one of the drives."""
    found = {(row.task, row.model, row.measure, row.condition): row for row in rows}

    def text(*place: str) -> str:
        row = found[place]  # pyright: ignore[reportArgumentType]
        return format_figure(row.mean, row.sd)

    tables = [
        terminal_table(
            f"{look_of(task).label}, {look_of(PAPER_MODEL).label}, simulated: relative alignment error",
            ["mean ± SD", *(f"noise {noise:g}" for noise in preset.noises)],
            [
                [name, *(text(task, PAPER_MODEL, ERROR, under(name, noise)) for noise in preset.noises)]
                for name in CONDITIONS
            ],
        )
        for task in dict.fromkeys(str(row.task) for row in rows if row.task != TASK)
    ]
    if (TASK, DRIVEN_MODEL, REACHED, DRIVEN[0]) in found:
        measures = [measure_name(found[TASK, DRIVEN_MODEL, name, DRIVEN[0]]) for name in (REACHED, TIME)]
        lines = [[name, *(text(TASK, DRIVEN_MODEL, one, name) for one in (REACHED, TIME))] for name in DRIVEN]
        title = f"Drives at the table, {look_of(DRIVEN_MODEL).label}, simulated"
        tables.append(terminal_table(title, ["mean ± SD", *measures], lines))
    return tables
