"""One cell of the comparison: one model on one fold of a dataset, under one noise, all its seeds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.demonstrations.split import Fold, select_episodes
from latentarm.models.decoder import Decoder
from latentarm.models.model import LatentActionModel
from latentarm.robots.catalogue import load_recorded_robot
from latentarm.robots.robot import Robot
from latentarm_research.studies.compare.datasets import Dataset
from latentarm_research.studies.compare.measures import measure_model
from latentarm_research.studies.compare.preset import Preset, Stream
from latentarm_research.studies.fitting import fit_model
from latentarm_research.studies.streams import integer, sequence

SEEDLESS: Final = "pca"  # nothing in it is random, so it is fitted once, not once per seed


@dataclass(frozen=True)
class Place:
    """Where a cell stands."""

    dataset: str  # its name
    noise_rad: float  # SD of the noise on states, in training and in the noisy error, rad
    model: str  # a name of `MODELS`
    fold: int  # index of the fold
    demonstrations: int  # how many train the model, the validation episodes among them


@dataclass(frozen=True, eq=False)
class FoldCell:
    """What is to be measured."""

    dataset: Dataset  # what is learned from
    noise_rad: float  # SD of the noise on states, rad
    model: str  # a name of `MODELS`
    fold: Fold  # which episodes do what
    preset: Preset  # sizes
    seed: int  # of everything random

    @property
    def place(self) -> Place:
        """Where it stands."""
        fold = self.fold
        return Place(self.dataset.name, self.noise_rad, self.model, fold.index, len(fold.others))


@dataclass(frozen=True, eq=False)
class FoldResult:
    """Results of one cell."""

    place: Place  # of the cell
    figures: Mapping[str, FloatArray]  # measure -> (S,), one figure per seed
    decoder: Decoder  # of the first seed


def measure_cell(cell: FoldCell) -> FoldResult:
    """Fit all seeds in one fit and measure them on the held-out episodes."""
    robot = load_recorded_robot(cell.dataset.demonstrations)
    model = _fit(cell, robot)
    figures = measure_model(
        model,
        cell.dataset.demonstrations,
        cell.fold.held_out,
        robot,
        cell.preset,
        np.random.default_rng(_stream(cell, Stream.TEST_NOISE)),
    )
    return FoldResult(
        place=cell.place,
        figures=figures,
        decoder=model.decoder(0),
    )


def _stream(cell: FoldCell, use: Stream) -> np.random.SeedSequence:
    """Where one use of randomness begins in a cell."""
    return sequence(cell.seed, cell.dataset.name, use, cell.fold.index)


def _fit(cell: FoldCell, robot: Robot) -> LatentActionModel:
    fold, preset = cell.fold, cell.preset
    return fit_model(
        cell.model,
        select_episodes(cell.dataset.demonstrations, (*fold.training, *fold.validation)),
        validation=range(len(fold.training), len(fold.training) + len(fold.validation)),
        fit={"chain": robot.chain},
        state_noise_rad=cell.noise_rad,
        data_seed=integer(_stream(cell, Stream.TRAINING_NOISE)),
        seeds=1 if cell.model == SEEDLESS else preset.seeds,
        seed=integer(_stream(cell, Stream.NETWORKS)),
        batch_size=preset.batch_size,
        hidden=preset.hidden,
        **({} if preset.epochs is None else {"epochs": preset.epochs}),
    )
