"""Holding out episodes: always whole ones, so that no motion is on both sides."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from latentarm.errors import UserError
from latentarm.types import Demonstrations, IntArray


def split_episodes(
    demonstrations: Demonstrations, held_out_fraction: float, rng: np.random.Generator
) -> tuple[IntArray, IntArray]:
    """Choose at random which episodes to train on and which to hold out.

    Args:
        demonstrations: at least two episodes.
        held_out_fraction: share of the episodes to hold out, within (0, 1); at least one episode
            ends up on each side.
        rng: decides which; the same generator state gives the same split.

    Returns:
        Indices (E_train,) and (E_held_out,) into ``demonstrations.episodes``, each rising.

    Raises:
        UserError: there are fewer than two episodes, or the fraction is not within (0, 1).
    """
    episodes = len(demonstrations.episodes)
    if not 0 < held_out_fraction < 1:
        raise UserError(f"The held-out fraction is {held_out_fraction:g}; it must lie between 0 and 1.")
    if episodes < 2:
        raise UserError(f"Holding out episodes needs at least two of them, and there is {episodes}.")
    held_out = min(max(round(held_out_fraction * episodes), 1), episodes - 1)
    order = rng.permutation(episodes).astype(np.int64)
    return np.sort(order[held_out:]), np.sort(order[:held_out])


def select_episodes(demonstrations: Demonstrations, episodes: Sequence[int] | IntArray) -> Demonstrations:
    """The same demonstrations with only the episodes at the given indices, in the given order.

    Raises:
        UserError: an index names no episode.
    """
    for index in episodes:
        if not 0 <= index < len(demonstrations.episodes):
            raise UserError(f"There is no episode {index}: the dataset has {len(demonstrations.episodes)}.")
    return replace(demonstrations, episodes=tuple(demonstrations.episodes[index] for index in episodes))
