"""The study's tables: in Markdown for the page, and at a glance for a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CHOICES, CurveResult
from latentarm_research.studies.alignment.drives import DRIVEN
from latentarm_research.studies.alignment.drives_learning import TASK
from latentarm_research.studies.alignment.drives_tables import REACHED, TIME
from latentarm_research.studies.alignment.hypotheses import PAPER_MODEL, AlignmentTarget
from latentarm_research.studies.alignment.preset import CONDITIONS, Preset, under
from latentarm_research.studies.alignment.rows import ENCODED, ERROR
from latentarm_research.studies.alignment.turning import TURNING, TurningResult
from latentarm_research.studies.tables import markdown_table


def condition_table(results: Sequence[AlignmentErrors]) -> str:
    """The relative errors of one task and model: conditions down, noises across."""
    lines = [[name, *(_mean_and_sd(result.errors[name]) for result in results)] for name in CONDITIONS]
    encoded = [ENCODED, *(format_figure(result.encoded, None) for result in results)]
    head = ["relative error, simulated", *(f"noise {result.cell.noise:g}" for result in results)]
    return markdown_table(head, [*lines, encoded])


def curve_table(curve: CurveResult) -> str:
    """One task, model and noise: numbers of answers down, choices of questions across."""
    counts = sorted({count for errors in curve.errors.values() for count in errors})
    lines = [
        [
            str(count),
            *(
                _mean_and_sd(curve.errors[choice][count]) if count in curve.errors[choice] else ABSENT
                for choice in CHOICES
            ),
        ]
        for count in counts
    ]
    return markdown_table(["answers", *CHOICES], lines)


def stopping_table(curves: Sequence[CurveResult]) -> str:
    """Where asking stops, and the error there."""
    head = ["", "model", "noise", "answers", "relative error"]
    lines = [
        [
            look_of(curve.cell.learned.cell.task).label,
            look_of(curve.cell.learned.cell.model).label,
            f"{curve.cell.noise:g}",
            _mean_and_sd(curve.stopped_after),
            _mean_and_sd(curve.stopped_at),
        ]
        for curve in curves
    ]
    return markdown_table(head, lines)


def turning_table(results: Sequence[TurningResult]) -> str:
    """Errors with people whose axes turn: conditions down, noises across."""
    lines = [
        [
            f"{name} ({len(results[0].errors[name])} people)",
            *(_mean_and_sd(one.errors[name]) for one in results),
        ]
        for name in TURNING
    ]
    return markdown_table(
        ["relative error, simulated", *(f"noise {one.cell.noise:g}" for one in results)], lines
    )


def target_table(found: Sequence[AlignmentTarget]) -> str:
    """Every target."""
    lines = [[one.name, "met" if one.met else "**missed**", one.figures] for one in found]
    return markdown_table(["target", "", "figures"], lines)


def summary_tables(rows: Sequence[Row], preset: Preset) -> list[Table]:
    """A table per task with the paper's model, conditions down, noises across, and one per driven model."""
    tasks = dict.fromkeys(row.task for row in rows if row.task != TASK)
    models = dict.fromkeys(row.model for row in rows if row.task == TASK)
    return [
        *(_conditions(rows, str(task), preset.noises) for task in tasks),
        *(_drives(rows, str(model)) for model in models),
    ]


def _conditions(rows: Sequence[Row], task: str, noises: Sequence[float]) -> Table:
    found = {
        row.condition: row for row in rows if (row.task, row.model, row.measure) == (task, PAPER_MODEL, ERROR)
    }
    title = f"{look_of(task).label}, {look_of(PAPER_MODEL).label}, simulated: relative alignment error"
    table = Table("mean ± SD", title=title, title_justify="left", box=SIMPLE_HEAD)
    for noise in noises:
        table.add_column(f"noise {noise:g}", justify="right")
    for name in CONDITIONS:
        cells = [found[under(name, noise)] for noise in noises]
        table.add_row(name, *(format_figure(row.mean, row.sd) for row in cells))
    return table


def _drives(rows: Sequence[Row], model: str) -> Table:
    found = {(row.condition, row.measure): row for row in rows if (row.task, row.model) == (TASK, model)}
    title = f"Drives at the table, {look_of(model).label}, simulated"
    table = Table("mean ± SD", title=title, title_justify="left", box=SIMPLE_HEAD)
    for measure in (REACHED, TIME):
        table.add_column(measure_name(found[DRIVEN[0], measure]), justify="right")
    for condition in DRIVEN:
        cells = [found[condition, measure] for measure in (REACHED, TIME)]
        table.add_row(condition, *(format_figure(row.mean, row.sd) for row in cells))
    return table


def _mean_and_sd(values: FloatArray) -> str:
    return format_figure(float(values.mean()), float(values.std(ddof=1)) if len(values) > 1 else None)
