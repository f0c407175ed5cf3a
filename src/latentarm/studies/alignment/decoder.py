"""The decoders that alignments stand on: each is learned once, from the demonstrations of one task."""

from dataclasses import dataclass
from time import perf_counter
from typing import Final

from threadpoolctl import threadpool_limits

from latentarm.models.model import LatentActionModel
from latentarm.studies.alignment.preset import Preset
from latentarm.studies.alignment.streams import Stream
from latentarm.studies.fitting import fit_model, validation_episodes
from latentarm.studies.streams import generator, integer, sequence
from latentarm.tasks.pouring.tasks import POURING_TASKS
from latentarm.types import Demonstrations

WINDOW: Final = 10
"""Samples that an action may reach ahead and back: half a second, as long as a motion that is asked about."""


@dataclass(frozen=True)
class DecoderCell:
    """A decoder to be learned.

    Attributes:
        task: a name of `POURING_TASKS`.
        model: a name of `MODELS`.
        preset: sizes of the study.
        seed: of the whole study; the same demonstrations come from it for every model.
    """

    task: str
    model: str
    preset: Preset
    seed: int


@dataclass(frozen=True, eq=False)
class LearnedDecoder:
    """A decoder that was learned.

    Attributes:
        cell: what was asked for.
        model: fitted, of one seed.
        fit_s: how long that took, s.
    """

    cell: DecoderCell
    model: LatentActionModel
    fit_s: float


def learn_decoder(cell: DecoderCell) -> LearnedDecoder:
    """Demonstrate and fit.

    The weights are the same to the last bit in whatever process this runs: one thread each for linear algebra
    and for torch, since more of them add up in another order.

    Raises:
        UserError: the preset's sizes make no sense to the model or to the task.
    """
    with threadpool_limits(limits=1):
        demonstrations = demonstrate(cell, Stream.TRAINING)
        began = perf_counter()
        model = _fit(cell, demonstrations)
        return LearnedDecoder(cell, model, perf_counter() - began)


def demonstrate(cell: DecoderCell, stream: Stream) -> Demonstrations:
    """The demonstrations for training or for testing: the same whenever they are asked for.

    Raises:
        UserError: the preset asks for none.
    """
    preset = cell.preset
    episodes = preset.episodes if stream == Stream.TRAINING else preset.test_episodes
    return POURING_TASKS[cell.task]().demonstrate(episodes, generator(cell.seed, cell.task, stream))


def _fit(cell: DecoderCell, demonstrations: Demonstrations) -> LatentActionModel:
    preset = cell.preset
    return fit_model(
        cell.model,
        demonstrations,
        validation=validation_episodes(demonstrations),
        latent_dim=2,
        window=WINDOW,
        state_noise_rad=preset.state_noise_rad,
        data_seed=integer(sequence(cell.seed, cell.task, Stream.STATE_NOISE)),
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
        fit={"chain": POURING_TASKS[cell.task]().robot.chain},
    )
