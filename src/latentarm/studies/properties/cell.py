"""One cell of the study: one model, on one task, under one noise, all its seeds."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from time import perf_counter
from typing import Final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.demonstrations.split import select_episodes
from latentarm.models.kind import Decoder
from latentarm.models.model import LatentActionModel
from latentarm.studies.fitting import fit_model, validation_episodes
from latentarm.studies.properties.measures import (
    accuracy_figures,
    control_figures,
    latent_figures,
    reach_figures,
    recorded_pairs,
    start_goal_pairs,
)
from latentarm.studies.properties.preset import Preset
from latentarm.studies.streams import generator, integer, sequence
from latentarm.tasks.planar.catalogue import MOTIONS
from latentarm.tasks.planar.reach import ReachRegion
from latentarm.types import Demonstrations, FloatArray

BASELINE: Final = "pca"
"""The baseline. Nothing in it is random, so it is fitted once, not once per seed."""


class Stream(IntEnum):
    """Streams of randomness: one per use, so that none depends on another's draws."""

    TRAINING = 0
    TEST = 1
    NETWORKS = 2
    TRAINING_NOISE = 3
    TEST_NOISE = 4
    PAIRS = 5
    GOALS = 6


@dataclass(frozen=True)
class Cell:
    """What is to be measured.

    Attributes:
        task: a name of `MOTIONS`.
        model: a name of `MODELS`.
        noise_rad: SD of the noise on states, in training and in the noisy error, rad.
        preset: sizes of the study.
        seed: of the whole study; the same demonstrations come from it for every model and noise.
    """

    task: str
    model: str
    noise_rad: float
    preset: Preset
    seed: int


def condition(noise_rad: float) -> str:
    """How rows name a noise."""
    return f"noise {noise_rad:g} rad"


@dataclass(frozen=True, eq=False)
class CellResult:
    """What was measured.

    Attributes:
        cell: what was asked for.
        figures: measure -> (S,), one figure per seed; (1,) for PCA, which knows no seed, and for what does
            not depend on the model.
        decoder: of the first seed, for figures.
        fit_s: how long the fit of all seeds took, s.
    """

    cell: Cell
    figures: Mapping[str, FloatArray]
    decoder: Decoder
    fit_s: float


def measure_cell(cell: Cell) -> CellResult:
    """Demonstrate, fit all seeds in one fit, measure.

    The figures are the same to the last bit in whatever process this runs: one thread each for linear algebra
    and for torch, since more of them add up in another order.

    Raises:
        UserError: the preset's sizes make no sense to the model or to the task.
    """
    with threadpool_limits(limits=1):
        return _measure(cell)


def _measure(cell: Cell) -> CellResult:
    motion, preset = MOTIONS[cell.task](), cell.preset
    training = motion.demonstrate(preset.episodes, _generator(cell, Stream.TRAINING))
    test = motion.demonstrate(preset.test_episodes, _generator(cell, Stream.TEST))
    began = perf_counter()
    model = _fit(cell, cell.model, training)
    fit_s = perf_counter() - began

    pairs = recorded_pairs(test, cell.noise_rad, _generator(cell, Stream.TEST_NOISE))
    chosen = select_episodes(training, range(validation_episodes(training).start))
    # Only the actions of these are used, so no noise is drawn.
    fitted = recorded_pairs(chosen, 0.0, _generator(cell, Stream.TRAINING_NOISE))
    decoders = [model.decoder(seed) for seed in range(model.seeds)]
    figures = accuracy_figures(model, decoders, fitted, pairs)
    figures |= latent_figures(motion, model, decoders, pairs, preset)
    if cell.noise_rad == 0 and isinstance(motion, ReachRegion):
        figures |= reach_figures(motion, decoders, preset.reach_goals, _generator(cell, Stream.GOALS))
    elif cell.noise_rad == 0:
        goals = start_goal_pairs(motion, test, preset.reach_pairs, _generator(cell, Stream.PAIRS))
        pca = _fit(cell, BASELINE, training).decoder()
        figures |= control_figures(motion, decoders, pca, goals)
    return CellResult(cell=cell, figures=figures, decoder=decoders[0], fit_s=fit_s)


def _fit(cell: Cell, kind: str, training: Demonstrations) -> LatentActionModel:
    preset = cell.preset
    return fit_model(
        kind,
        training,
        validation=validation_episodes(training),
        latent_dim=MOTIONS[cell.task]().latent_dim,
        actions="recorded",
        state_noise_rad=cell.noise_rad,
        data_seed=integer(sequence(cell.seed, cell.task, Stream.TRAINING_NOISE)),
        seeds=1 if kind == BASELINE else preset.seeds,
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
        kl_weight=preset.kl_weight,
    )


def _generator(cell: Cell, stream: Stream) -> np.random.Generator:
    """The same for every model and noise."""
    return generator(cell.seed, cell.task, stream)
