"""`latentarm evaluate`: the properties of a trained model."""

import json as json_format
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from latentarm.commands.configuration import write_options
from latentarm.commands.output import print_renderables, say
from latentarm.core.types import Row
from latentarm.evaluation.measures import (
    ARROWS,
    AT_REST,
    ENCODED,
    EXPRESSED,
    PROPERTIES,
    label_of,
    measure_of,
)
from latentarm.evaluation.table import format_figure, measure_name
from latentarm.runs.options import EvaluateOptions

if TYPE_CHECKING:
    from latentarm.runs.evaluating import Evaluation

GROUPS = ("", EXPRESSED, ENCODED, PROPERTIES, AT_REST)  # headings in the order of the table


def evaluation_table(evaluation: "Evaluation") -> RenderableType:
    """Measures in rows, grouped; the run's own split and the folds, if any, in columns."""
    from latentarm.runs.evaluating import OVER_FOLDS

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
        better = ARROWS[measure.better] if measure else ""
        cells = [measure_name(row), better, format_figure(row.mean, row.sd)]
        other = folds.get(row.measure)
        if other is not None:
            cells.append(format_figure(other.mean, other.sd))
        table.add_row(*map(Text, cells))
    return table


def definitions(rows: Sequence[Row]) -> RenderableType:
    """One sentence on each measure; single axes share the sentence of their measure."""
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for name in dict.fromkeys(row.measure.rpartition("_axis_")[0] or row.measure for row in rows):
        measure = measure_of(name)
        if measure is not None:
            table.add_row(Text(label_of(name)), Text(f"{measure.definition}."))
    return table


def evaluate(options: EvaluateOptions) -> int:
    """Measure a trained model on held-out episodes: four properties, drift, reversal, and a verdict.

    For example: latentarm evaluate runs/pour-cae
    """
    from latentarm.runs.evaluating import evaluate_run

    evaluation = evaluate_run(options)
    folder, json = options.folder, options.json
    write_options(folder, "evaluate")
    if json:
        _print_json(evaluation)
    else:
        print_renderables(evaluation_table(evaluation))
        if options.explain:
            print_renderables(definitions(evaluation.rows))
        else:
            say("To explain the measures: --explain.", json)
    if evaluation.missing:
        say(evaluation.missing, json)
    say(evaluation.verdict, json)
    say(evaluation.advice, json)
    say(f"metrics.json and figures are in {folder}/.", json)
    return 0


def _print_json(evaluation: "Evaluation") -> None:
    """Rows with what their measures mean; the last one holds the verdict."""
    from latentarm.runs.evaluating import findings_row

    document: list[dict[str, object]] = []
    said = {one.measure: one.said for one in evaluation.found}
    for row in [*evaluation.rows, findings_row(evaluation)]:
        measure = measure_of(row.measure)
        meaning = {} if measure is None else {"better": measure.better, "definition": measure.definition}
        document.append(
            row.as_json() | {"label": label_of(row.measure), "finding": said.get(row.measure)} | meaning
        )
    document[-1] |= {
        "verdict": evaluation.verdict,
        "findings": [one.said for one in evaluation.found],
        "next": evaluation.advice,
    }
    print(json_format.dumps(document, indent=2))
