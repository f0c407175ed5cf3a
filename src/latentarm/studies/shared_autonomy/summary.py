"""The study at a glance, for a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table

from latentarm.metrics.table import ABSENT, format_figure, measure_name
from latentarm.studies.shared_autonomy.cell import METHODS
from latentarm.studies.shared_autonomy.hypotheses import MEASURE
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.style import look_of
from latentarm.types import Row


def summary_tables(rows: Sequence[Row]) -> list[Table]:
    """One table per arm: the final state error with the paper's model, people down, methods across.

    Args:
        rows: of the study.
    """
    chosen = [row for row in rows if (row.measure, row.model) == (MEASURE, MODEL)]
    return [
        _table([row for row in chosen if row.task == task])
        for task in dict.fromkeys(row.task for row in chosen)
    ]


def _table(rows: Sequence[Row]) -> Table:
    found = {row.condition: format_figure(row.mean, row.sd) for row in rows}
    label = f"{look_of(rows[0].task or '').label}, {look_of(MODEL).label}, simulated: {measure_name(rows[0])}"
    table = Table("mean ± SD", title=label, title_justify="left", box=SIMPLE_HEAD)
    for method in METHODS:
        table.add_column(method, justify="right")
    parted = [(row.condition or "").partition(", ") for row in rows]
    for person in dict.fromkeys(person for method, _, person in parted if method in METHODS):
        table.add_row(person, *(found.get(f"{method}, {person}", ABSENT) for method in METHODS))
    return table
