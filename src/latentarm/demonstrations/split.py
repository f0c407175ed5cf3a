"""Splitting a dataset by whole episodes, so that no motion is on both sides."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from latentarm.errors import UserError
from latentarm.types import Demonstrations, IntArray


def split_episodes(
    demonstrations: Demonstrations, fraction: float, rng: np.random.Generator
) -> tuple[IntArray, IntArray]:
    """Choose at random which episodes to train on and which to keep for evaluation or validation.

    Args:
        demonstrations: at least two episodes.
        fraction: share of the episodes to keep back, within (0, 1); at least one episode
            ends up on each side.
        rng: decides which; the same generator state gives the same split.

    Returns:
        Indices (E_train,) and (E_kept,) into ``demonstrations.episodes``, each rising.

    Raises:
        UserError: there are fewer than two episodes, or the fraction is not within (0, 1).
    """
    episodes = len(demonstrations.episodes)
    if not 0 < fraction < 1:
        raise UserError(f"The share of episodes to keep back is {fraction:g}; it must lie between 0 and 1.")
    if episodes < 2:
        raise UserError(f"Keeping episodes back needs at least two of them, and there is {episodes}.")
    kept = min(max(round(fraction * episodes), 1), episodes - 1)
    order = rng.permutation(episodes).astype(np.int64)
    return np.sort(order[kept:]), np.sort(order[:kept])


def select_episodes(demonstrations: Demonstrations, episodes: Sequence[int] | IntArray) -> Demonstrations:
    """The same demonstrations with only the episodes at the given indices, in the given order.

    Raises:
        UserError: an index names no episode.
    """
    for index in episodes:
        if not 0 <= index < len(demonstrations.episodes):
            raise UserError(f"There is no episode {index}: the dataset has {len(demonstrations.episodes)}.")
    return replace(demonstrations, episodes=tuple(demonstrations.episodes[index] for index in episodes))
