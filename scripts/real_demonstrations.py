"""Measure every model on recorded demonstrations: the tables of docs/results.md.

    python scripts/real_demonstrations.py ../shared/demonstrations runs/real

The first folder holds NumPy archives as `latentarm import` reads them; nothing is written there.
It does what the commands in docs/results.md do, for every archive, model and state noise.
"""

import sys
from pathlib import Path

from latentarm.demonstrations.importing import import_to
from latentarm.experiments.evaluating import evaluate_run
from latentarm.experiments.training import TrainConfig, train_run
from latentarm.metrics.table import markdown_table
from latentarm.robots.catalogue import load_robot
from latentarm.types import Row

MODELS = ("pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl")
NOISES_RAD = (0.01, 0.1)
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


def measure(archive: Path, out: Path, noise_rad: float) -> list[Row]:
    """Import once, then train and evaluate every model with five seeds."""
    dataset = out / archive.stem
    if not dataset.exists():
        import_to(archive, dataset, load_robot("panda"))
    rows: list[Row] = []
    for model in MODELS:
        run = out / f"{archive.stem}-{model}-{noise_rad:g}"
        train_run(TrainConfig(dataset, model, run, seeds=5, state_noise_rad=noise_rad, progress=True))
        rows += evaluate_run(run, run, seed=0)
    return [row for row in rows if row.measure in SHOWN]


def main(archives: Path, out: Path) -> None:
    """Print one Markdown table per archive and noise."""
    for noise_rad in NOISES_RAD:
        for archive in sorted(archives.glob("*.npz")):
            rows = measure(archive, out, noise_rad)
            print(f"\n**{archive.stem}**, state noise {noise_rad:g} rad\n\n{markdown_table(rows)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
