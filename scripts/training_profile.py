"""Where the time of a training step goes, by model.

Each model is fitted to the same demonstrations of the table-top task for a few epochs, and the parts of its
steps are timed on their own, in turn, on one thread: processor time, which other work on the machine
disturbs little.

    python scripts/training_profile.py
    python scripts/training_profile.py --models cae homogeneous --hidden 64 64 --batch 100

Columns, µs per step of all seeds: filling the batch; the gradient, computed afresh and replayed; Adam; the
judging of the validation pairs after an epoch, divided by its steps.
"""

import argparse
import statistics
import time
import warnings
from collections.abc import Callable
from typing import Any
from unittest.mock import patch

import numpy as np
import torch

from latentarm.models import training
from latentarm.models.batches import Batches, seed_generator
from latentarm.models.catalogue import MODELS
from latentarm.models.networks import FlatNetworks
from latentarm.models.optimiser import FlatAdam
from latentarm.models.replay import Replay
from latentarm.tasks.table_top import TableTop

CPU = torch.device("cpu")


class ArgumentsTakenError(Exception):
    """What `train` would have been called with."""


def arguments_of_train(model: Any, demonstrations: Any) -> tuple[Any, ...]:
    """Objective, shapes, noise, data, seeds and configuration with which a fit calls `train`."""

    def take(*args: Any, **_: Any) -> None:
        raise ArgumentsTakenError(*args)

    try:
        with patch("latentarm.models.neural.train", take):
            model.fit(demonstrations)
    except ArgumentsTakenError as taken:
        return taken.args
    raise SystemExit(f"{model.kind.name} is not trained in steps.")


def median_us(parts: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """Median processor time of each, in turn."""
    took: dict[str, list[float]] = {name: [] for name in parts}
    for _ in range(repeats):
        for name, part in parts.items():
            began = time.process_time()
            for _ in range(10):
                part()
            took[name].append((time.process_time() - began) / 10)
    return {name: 1e6 * statistics.median(times) for name, times in took.items()}


def profile(name: str, demonstrations: Any, options: argparse.Namespace) -> dict[str, float]:
    """The columns of one model."""
    model = MODELS[name](seeds=options.seeds, hidden=tuple(options.hidden), batch_size=options.batch)
    objective, shapes, noise_dim, data, seeds, config = arguments_of_train(model, demonstrations)
    networks = FlatNetworks(shapes, CPU)
    networks.initialise([seed_generator(seed, 0) for seed in seeds], {})
    batches, adam = Batches(data, seeds, config.batch_size, noise_dim, CPU), FlatAdam(networks.values)

    def afresh() -> None:
        networks.fill_gradient(objective(networks.networks, batches.batch).sum())

    def epoch() -> None:
        for _ in batches.epoch(1):
            pass

    def judge() -> None:
        training.validation_loss(objective, networks, batches)

    epoch()
    steps = {
        "gradient, afresh": afresh,
        "gradient, replayed": Replay(afresh, [*batches.batch, networks.values], CPU),
        "Adam": lambda: adam.step(networks.values, networks.gradient, 0.0),
    }
    passes = median_us({"batch": epoch, "validation": judge}, 3)
    row = {part: took / batches.steps for part, took in passes.items()} | median_us(steps, options.repeats)
    return row | {"step": sum(took for part, took in row.items() if part != "gradient, afresh")}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--models", nargs="+", default=["cae", "cvae", "scl", "homogeneous"])
    parser.add_argument("--hidden", nargs="+", type=int, default=[30, 30])
    parser.add_argument("--batch", type=int, default=400)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--episodes", type=int, default=12)
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    torch.set_num_threads(1)
    demonstrations = TableTop().demonstrate(options.episodes, np.random.default_rng(0))
    columns = ("batch", "gradient, afresh", "gradient, replayed", "Adam", "validation", "step")
    print(f"| {options.seeds} seeds, batch {options.batch} | " + " | ".join(columns) + " |")
    print("|---|" + "---:|" * len(columns))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name in options.models:
            row = profile(name, demonstrations, options)
            print(f"| {name} | " + " | ".join(f"{row[column]:.0f}" for column in columns) + " |", flush=True)


if __name__ == "__main__":
    main()
