"""`latentarm evaluate`: the properties of a trained model."""

import json as json_format
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Jobs, Json, MovedDataset, Seed
from latentarm.commands.output import print_renderables, say

if TYPE_CHECKING:
    from latentarm.runs.evaluating import Evaluation


def evaluate(
    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")],
    folds: Annotated[
        int | None,
        arg(
            help="Refit with each episode held out once, in so many parts, the run's own split among them; 0"
            " measures that split alone. By default 5 with 20 episodes or fewer, else 0."
        ),
    ] = None,
    explain: Annotated[bool, arg(help="Print what each measure says.")] = False,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for metrics and figures; RUN by default.")
    ] = None,
    demonstrations: MovedDataset = None,
    seed: Seed = 0,
    jobs: Jobs = -1,
    json: Json = False,
) -> int:
    """Measure a trained model on held-out episodes: the four properties, drift and reversal, and a verdict.

    For example: latentarm evaluate runs/pour-cae
    """
    from latentarm.runs.evaluating import evaluate_run

    folder = out or run
    bars = not json and sys.stderr.isatty()
    evaluation = evaluate_run(run, folder, seed, demonstrations, folds=folds, jobs=jobs, bars=bars)
    write_options(folder, "evaluate")
    if json:
        _print_json(evaluation)
    else:
        from latentarm.commands.evaluation_tables_body import definitions, evaluation_table

        print_renderables(evaluation_table(evaluation))
        if explain:
            print_renderables(definitions(evaluation.rows))
        else:
            say("What each measure says: --explain.", json)
    say(evaluation.verdict, json)
    say(evaluation.advice, json)
    say(f"metrics.json and figures are in {folder}/.", json)
    return 0


def _print_json(evaluation: "Evaluation") -> None:
    """Rows with what their measures mean; the last one holds the verdict."""
    from latentarm.metrics.measures import label_of, measure_of
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
