"""`latentarm evaluate`: the properties of a trained model."""

from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.options import Json, MovedDataset, Seed
from latentarm.commands.output import say, show


def evaluate(
    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for metrics and figures; RUN by default.")
    ] = None,
    demonstrations: MovedDataset = None,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Measure a trained model on its held-out episodes: the four properties, drift and reversal.

    For example: latentarm evaluate runs/pour-cae
    """
    from latentarm.experiments.evaluating import evaluate_run

    folder = out or run
    rows = evaluate_run(run, folder, seed, demonstrations)
    show(rows, json)
    say(f"metrics.json and figures are in {folder}/.", json)
    return 0
