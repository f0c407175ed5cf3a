"""One cell of the study: one model, on one task, all its seeds."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import Final

import numpy as np

from latentarm.core.types import Demonstrations, FloatArray
from latentarm.demonstrations.split import select_episodes
from latentarm.models.decoder import Decoder
from latentarm.models.model import LatentActionModel
from latentarm_research.studies.fitting import fit_each, validation_episodes
from latentarm_research.studies.properties import measures
from latentarm_research.studies.properties.preset import Preset
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.tasks.planar.catalogue import MOTIONS
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.reach import ReachRegion

BASELINE: Final = "pca"  # the baseline of controllability


class Stream(IntEnum):
    """Streams of randomness: one per use, so that none depends on another's draws."""

    TRAINING = 0
    TEST = 1
    NETWORKS = 2
    TRAINING_PAIRS = 3
    TEST_PAIRS = 4
    PAIRS = 5
    GOALS = 6


@dataclass(frozen=True)
class PropertiesCell:
    """What is to be measured."""

    task: str  # a name of `MOTIONS`
    model: str  # a name of `MODELS`
    preset: Preset  # sizes of the study
    seed: int  # of the whole study; the same demonstrations come from it for every kind of model


@dataclass(frozen=True, eq=False)
class PropertiesResult:
    """Results of one cell."""

    cell: PropertiesCell
    # measure -> (S,), one figure per seed; each seed has demonstrations of its own
    figures: Mapping[str, FloatArray]
    decoder: Decoder  # of the first seed, for figures


Demonstrated = tuple[Demonstrations, Demonstrations]
"""One seed's demonstrations: to fit a model to, and those that its figures are taken on."""


@lru_cache(maxsize=2)
def demonstrated(
    task: str,  # a name of `MOTIONS`
    sizes: tuple[int, int],
    seeds: int,
    seed: int,
) -> tuple[Demonstrated, ...]:
    """The demonstrations of every seed, the same for every kind of model."""
    motion = MOTIONS[task]()
    return tuple(
        (
            motion.demonstrate(sizes[0], generator(seed, task, Stream.TRAINING, index)),
            motion.demonstrate(sizes[1], generator(seed, task, Stream.TEST, index)),
        )
        for index in range(seeds)
    )


def measure_cell(cell: PropertiesCell) -> PropertiesResult:
    """Demonstrate, fit all seeds in one fit, measure."""
    preset = cell.preset
    motion = MOTIONS[cell.task]()
    sizes = preset.episodes, preset.test_episodes
    shown = demonstrated(cell.task, sizes, preset.seeds, cell.seed)
    models = _fit(cell, cell.model, shown)
    baselines = _fit(cell, BASELINE, shown)
    each = [
        _figures(cell, motion, index, *of_seed)
        for index, of_seed in enumerate(zip(shown, models, baselines, strict=True))
    ]
    return PropertiesResult(
        cell=cell,
        figures={name: np.concatenate([figures[name] for figures in each]) for name in each[0]},
        decoder=models[0].decoder(),
    )


def _figures(
    cell: PropertiesCell,
    motion: PlanarMotion,
    index: int,
    shown: Demonstrated,
    model: LatentActionModel,
    baseline: LatentActionModel,
) -> dict[str, FloatArray]:
    """The figures of one seed, by its index: measure -> (1,)."""

    def draws(stream: Stream) -> np.random.Generator:
        """The same for every kind of model."""
        return generator(cell.seed, cell.task, stream, index)

    preset, (training, test) = cell.preset, shown
    pairs = measures.recorded_pairs(test, draws(Stream.TEST_PAIRS))
    chosen = select_episodes(training, range(validation_episodes(training).start))
    fitted = measures.recorded_pairs(chosen, draws(Stream.TRAINING_PAIRS))
    decoders = [model.decoder()]
    figures = measures.accuracy_figures(model, decoders, fitted, pairs)
    figures |= measures.latent_figures(motion, model, decoders, pairs, preset)
    if isinstance(motion, ReachRegion):
        figures |= measures.reach_figures(motion, decoders, preset.reach_goals, draws(Stream.GOALS))
    else:
        goals = measures.start_goal_pairs(motion, test, preset.reach_pairs, draws(Stream.PAIRS))
        figures |= measures.control_figures(motion, decoders, baseline.decoder(), goals)
    return figures


def _fit(cell: PropertiesCell, kind: str, shown: tuple[Demonstrated, ...]) -> list[LatentActionModel]:
    preset = cell.preset
    return fit_each(
        kind,
        [training for training, _ in shown],
        validation=validation_episodes(shown[0][0]),
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        kl_weight=preset.kl_weight,
        latent_dim=MOTIONS[cell.task]().latent_dim,
        actions="recorded",
        state_noise_rad=0.0,
        data_seed=integer(sequence(cell.seed, cell.task, Stream.TRAINING_PAIRS)),
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
    )
