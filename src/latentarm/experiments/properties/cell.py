"""One cell of the study: one model, on one task, under one noise, all its seeds."""

from collections.abc import Mapping
from dataclasses import dataclass

from latentarm.experiments.properties.preset import Preset
from latentarm.models.decoder import Decoder
from latentarm.types import FloatArray


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


@dataclass(frozen=True, eq=False)
class CellResult:
    """What was measured.

    Attributes:
        cell: what was asked for.
        figures: measure -> (S,), one figure per seed.
        decoder: of the first seed, for figures.
        fit_s: how long the fit of all seeds took, s.
    """

    cell: Cell
    figures: Mapping[str, FloatArray]
    decoder: Decoder
    fit_s: float
