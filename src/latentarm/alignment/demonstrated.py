"""Motions to ask about, taken from the demonstrations."""

from typing import Final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.error import lengths
from latentarm.core.context import JOINTS, Named
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, Demonstrations, Episode, FloatArray
from latentarm.demonstrations.contexts import episode_contexts
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.stillness import moving_range

DURATION_S: Final = 0.5
"""How long a shown motion takes, s: long enough to be seen, short enough to be one push of the stick."""

CANDIDATES: Final = 100  # motions that may be asked about
KEPT: Final = 1000  # motions that show the directions of a place; the first of them may be asked about


def demonstrated_motions(
    demonstrations: Demonstrations,
    count: int,
    rng: np.random.Generator,
    *,
    context: Named = (JOINTS,),
    duration_s: float = DURATION_S,
) -> Motions:
    """Motions that were demonstrated, drawn at random from all samples while an arm moves.

    A motion ends where the demonstration was ``duration_s`` later, between samples if need be. There are
    ``count`` of them, or all where there are fewer.

    Raises UserError where no motion is that long, or a feature of the context is missing.
    """
    every = [_motions(episode, duration_s, context) for episode in demonstrations.episodes]
    start, end, rest = (np.concatenate(parts) for parts in zip(*every, strict=True))
    if not len(start):
        raise UserError(f"No demonstration moves for {duration_s:g} s: there is no motion to ask about.")
    rows = rng.permutation(len(start))[:count]
    return Motions(start[rows], end[rows], duration_s, rest[rows])


def noticeable(motions: Motions, chain: Chain) -> BoolArray:
    """Which motions (N,) a person can tell from standing still: those at least half as long as the median."""
    length = lengths(chain, motions)
    return length >= 0.5 * np.median(length)


def shown(demonstrations: Demonstrations, context: Named, chain: Chain, rng: np.random.Generator) -> Motions:
    """Motions that a person can tell from standing still; the first `CANDIDATES` may be asked about.

    They come from the demonstrations that trained the model, so that others can still judge it.

    Raises UserError where no demonstration moves for long enough, or a feature of the context is missing.
    """
    many = demonstrated_motions(demonstrations, KEPT, rng, context=context)
    return many[np.flatnonzero(noticeable(many, chain))]


def _motions(
    episode: Episode, duration_s: float, context: Named
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """All motions of an episode: states before and after, and the rest of the contexts before."""
    first, stop = moving_range(episode.state, episode.timestamp)
    if stop == first:
        first, stop = 0, 1  # one sample, from which no motion leads
    state, time = episode.state[first:stop], episode.timestamp[first:stop]
    # Timestamps such as 0.1 k carry rounding: a motion that ends with the last sample counts.
    starts = np.flatnonzero(time + duration_s <= time[-1] + 1e-6)
    later = time[starts] + duration_s
    ends = [np.interp(later, time, joint) for joint in state.T]
    rest = episode_contexts(episode, context)[first:stop][starts, state.shape[1] :]
    return state[starts], np.stack(ends, axis=-1), rest
