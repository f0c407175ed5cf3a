"""The study at a glance, for a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table

from latentarm.metrics.looks import look_of
from latentarm.metrics.table import format_figure, measure_name
from latentarm.studies.alignment.conditions import CONDITIONS, under
from latentarm.studies.alignment.drives import DRIVEN
from latentarm.studies.alignment.drives_comparison import REACHED, TIME
from latentarm.studies.alignment.drives_learning import TASK
from latentarm.studies.alignment.preset import Preset
from latentarm.studies.alignment.rows import ERROR
from latentarm.studies.alignment.targets import PAPER_MODEL
from latentarm.types import Row


def summary_tables(rows: Sequence[Row], preset: Preset) -> list[Table]:
    """A table per task with the paper's model, conditions down and noises across, and one per driven model.

    Args:
        rows: of the study.
        preset: for the noises.
    """
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
