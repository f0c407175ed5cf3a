"""The lesson of a training for a person: short recordings, and the effect of each direction."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.recordings.dataset_export import ImplausibleWarning, demonstrations_of
from latentarm.recordings.journal_reader import JournalEpisode
from latentarm.web.protocol.learning_messages import Lesson

SHORT_SHARE: Final = 0.5  # a recording that moves for less than this share of the usual one is short
WEAK_SHARE: Final = 0.2
"""A direction that moves the tool less than this share of the strongest one does little."""

WEAK_M_S: Final = 0.01  # one that moves the tool more slowly than this does little, whatever the others do
TURN_M: Final = 0.1  # turning the tool by one radian counts as moving it so far, m
_MOST_SAMPLES: Final = 200


def moving_seconds(episode: JournalEpisode, rate_hz: float) -> float:
    """How long the arm moves in a recording with ``rate_hz`` samples per second, s; 0 if it is unusable."""
    from latentarm.demonstrations.pauses import without_pauses

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)
            alone = demonstrations_of([episode], source="The recording")
        return float(without_pauses(alone, rate_hz).episodes[0].timestamp[-1])
    except UserError:
        return 0.0


def lesson_of(run: Path, demonstrations: Demonstrations, moved_s: Mapping[int, float]) -> Lesson:
    """The lesson of a new run; ``moved_s``: how long the arm moves in each recording, by number, s.

    Raises UserError if the run cannot be read.
    """
    usual_s = median(moved_s.values())
    speeds = _speeds(run, demonstrations)
    least = max(WEAK_M_S, WEAK_SHARE * max(speeds))
    return Lesson(
        recordings=len(moved_s),
        learned_from=len(demonstrations.episodes) - _checking(run),
        short=tuple(number for number, seconds in moved_s.items() if seconds < SHORT_SHARE * usual_s),
        speeds_m_s=tuple(round(speed, 3) for speed in speeds),
        weak=tuple(axis for axis, speed in enumerate(speeds) if speed < least),
    )


def _checking(run: Path) -> int:
    """Episodes that the run was not fitted to: those that stopped its training, and those held out."""
    from latentarm.models.saving import read_model
    from latentarm.runs.folder import read_run

    return len(read_model(run).summary.validation_episodes) + len(read_run(run).held_out)


def _speeds(run: Path, demonstrations: Demonstrations) -> Sequence[float]:
    """How fast a full push moves the tool along each axis, the median over the recordings, m/s."""
    from latentarm.demonstrations.contexts import episode_contexts
    from latentarm.models.saving import load_decoder
    from latentarm.runs.folder import read_run, robot_of

    decoder = load_decoder(run, 0)
    chain = robot_of(read_run(run)).chain
    states = np.concatenate([episode.state for episode in demonstrations.episodes])
    contexts = np.concatenate(
        [episode_contexts(episode, decoder.layout.features) for episode in demonstrations.episodes]
    )
    every = max(1, len(states) // _MOST_SAMPLES)
    jacobian = chain.jacobian(states[::every])
    found: list[float] = []
    for axis in range(decoder.latent_dim):
        push = np.zeros((2, 1, decoder.latent_dim))
        push[0, :, axis], push[1, :, axis] = 1.0, -1.0
        twist = np.einsum("nij,snj->sni", jacobian, decoder.decode(push, contexts[None, ::every]))
        twist[..., 3:] *= TURN_M
        found.append(float(np.median(np.linalg.norm(twist, axis=-1))))
    return found
