"""Measure every model on recorded demonstrations, over several choices of the held-out episodes.

    python scripts/real_demonstrations.py ../shared/demonstrations runs/real

The first folder holds NumPy archives as `latentarm import` reads them; nothing is written there. Every
run is what `latentarm train --seeds 2 --seed SPLIT` and `latentarm evaluate` do. These are the tables of
docs/results.md.
"""

import sys
from pathlib import Path
from typing import cast

import numpy as np
from joblib import Parallel, delayed

from latentarm.demonstrations.importing import import_to
from latentarm.experiments.evaluating import evaluate_run
from latentarm.experiments.training import TrainConfig, train_run
from latentarm.metrics.summary import Subject, summarise
from latentarm.metrics.table import markdown_table
from latentarm.robots.catalogue import load_robot
from latentarm.types import Row

MODELS = ("pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl", "isometric")
SPLITS = range(5)
SHOWN = (
    "error_percent_of_pca",
    "noise_free_error_percent_of_pca",
    "controllability_m",
    "r2_axis_0",
    "r2_axis_1",
    "r2_local_axis_0",
    "r2_local_axis_1",
    "disentanglement_deg",
    "drift",
    "reversal",
)


def measure(dataset: Path, model: str, split: int) -> list[Row]:
    """Train and evaluate two models of a kind on one split."""
    run = dataset.with_name(f"{dataset.name}-{model}-{split}")
    train_run(TrainConfig(dataset, model, run, seeds=2, seed=split))
    return evaluate_run(run, run, seed=split)


def over_splits(model: str, runs: list[list[Row]]) -> list[Row]:
    """Mean and SD over splits of the figures, each of which is the mean of a split's two models."""
    means = {
        measure: [row.mean for run in runs for row in run if row.measure == measure] for measure in SHOWN
    }
    subject = Subject("evaluate", model=model)
    known = {name: [value for value in values if value is not None] for name, values in means.items()}
    return [summarise(subject, name, np.array(values)) for name, values in known.items()]


def main(archives: Path, out: Path) -> None:
    """Print one Markdown table per archive."""
    for archive in sorted(archives.glob("*.npz")):
        dataset = out / archive.stem
        import_to(archive, dataset, load_robot("panda"))
        calls = [delayed(measure)(dataset, model, split) for model in MODELS for split in SPLITS]
        results = cast(list[list[Row]], Parallel(n_jobs=2)(calls))
        per_model = [results[index : index + len(SPLITS)] for index in range(0, len(results), len(SPLITS))]
        rows = [
            row for model, runs in zip(MODELS, per_model, strict=True) for row in over_splits(model, runs)
        ]
        print(f"\n**{archive.stem}**\n\n{markdown_table(rows)}", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
