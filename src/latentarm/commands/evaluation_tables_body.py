"""What `latentarm evaluate` prints: measures in groups, which way is better, and what they say."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from latentarm.metrics.measures import ARROWS, AT_REST, PROPERTIES, RECONSTRUCTION, label_of, measure_of
from latentarm.metrics.table import format_figure, measure_name
from latentarm.runs.evaluating import OVER_FOLDS, Evaluation
from latentarm.types import Row

GROUPS = ("", RECONSTRUCTION, PROPERTIES, AT_REST)
"""Headings in the order of the table."""


def evaluation_table(evaluation: Evaluation) -> RenderableType:
    """Measures down, in groups; the run's own split and, where there are some, the folds across."""
    own = [row for row in evaluation.rows if row.condition is None]
    own.sort(key=lambda row: GROUPS.index(measure.group) if (measure := measure_of(row.measure)) else -1)
    folds = {row.measure: row for row in evaluation.rows if row.condition == OVER_FOLDS}
    table = Table(title=f"{own[0].model} on {own[0].task}", title_justify="left", box=SIMPLE_HEAD)
    table.add_column("mean ± SD")
    table.add_column("better")
    table.add_column(f"own split, over {own[0].n} seed{'s' if own[0].n != 1 else ''}", justify="right")
    if folds:
        table.add_column(f"over {folds[own[0].measure].n} folds", justify="right")
    group = ""
    for row in own:
        measure = measure_of(row.measure)
        if measure is not None and measure.group != group:
            group = measure.group
            table.add_section()
            table.add_row(Text(group, style="bold"))
        cells = [
            measure_name(row),
            ARROWS[measure.better] if measure else "",
            format_figure(row.mean, row.sd),
        ]
        other = folds.get(row.measure)
        if other is not None:
            cells.append(format_figure(other.mean, other.sd))
        table.add_row(*map(Text, cells))
    return table


def definitions(rows: Sequence[Row]) -> RenderableType:
    """One sentence on each measure; those of single axes are those of the measure."""
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for name in dict.fromkeys(row.measure.rpartition("_axis_")[0] or row.measure for row in rows):
        measure = measure_of(name)
        if measure is not None:
            table.add_row(Text(label_of(name)), Text(f"{measure.definition}."))
    return table
