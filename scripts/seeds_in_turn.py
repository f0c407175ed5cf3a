"""Ten seeds of a model in one fit, beside the same ten one after the other: seconds, and that they agree.

For example: python scripts/seeds_in_turn.py sine cae
"""

import sys
from dataclasses import replace
from statistics import median
from time import perf_counter

import numpy as np

from latentarm.models.catalogue import MODELS
from latentarm_research.studies.properties.preset import PRESETS
from latentarm_research.tasks.planar.catalogue import MOTIONS

REPEATS = 3


def main(task: str, kind: str) -> None:
    """Time both ways in turn, so that a change in the machine's load meets both."""
    preset, motion = PRESETS["paper"], MOTIONS[task]()
    shown = motion.demonstrate(preset.episodes, np.random.default_rng(0))
    model = MODELS[kind](
        latent_dim=motion.latent_dim,
        actions="recorded",
        seeds=preset.seeds,
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
    )
    validation = range(preset.episodes * 4 // 5, preset.episodes)
    at_once, in_turn = [], []
    for _ in range(REPEATS):
        began = perf_counter()
        together = replace(model).fit(shown, validation=validation)
        at_once.append(perf_counter() - began)
        began = perf_counter()
        losses = [
            replace(model, seeds=1, seed=seed).fit(shown, validation=validation).validation_loss_[0]
            for seed in range(preset.seeds)
        ]
        in_turn.append(perf_counter() - began)
    apart = np.abs(np.array(losses) / together.validation_loss_ - 1).max()
    print(f"{task}, {kind}, {preset.seeds} seeds, {preset.epochs} epochs, median of {REPEATS}:")
    print(f"in one fit {median(at_once):.1f} s, one after the other {median(in_turn):.1f} s")
    print(
        f"in turn over at once {median(in_turn) / median(at_once):.1f}; losses differ by {apart:.1%} at most"
    )


if __name__ == "__main__":
    main(*(sys.argv[1:] or ("sine", "cae")))
