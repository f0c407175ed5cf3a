"""Splits a dataset by whole episodes, once or into folds, so that no motion is on both sides."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, IntArray


def split_episodes(
    demonstrations: Demonstrations, fraction: float, rng: np.random.Generator
) -> tuple[IntArray, IntArray]:
    """Draw rising indices (E_train,) and (E_kept,), at least one each; a ``fraction`` is kept back."""
    episodes = len(demonstrations.episodes)
    if not 0 < fraction < 1:
        raise UserError(f"The share of episodes to keep back is {fraction:g}; it must lie between 0 and 1.")
    if episodes < 2:
        raise UserError(f"Keeping episodes back needs at least two of them, and there is {episodes}.")
    kept = min(max(round(fraction * episodes), 1), episodes - 1)
    order = rng.permutation(episodes).astype(np.int64)
    return np.sort(order[kept:]), np.sort(order[:kept])


def select_episodes(demonstrations: Demonstrations, episodes: Sequence[int] | IntArray) -> Demonstrations:
    """The demonstrations with only the given episodes, in the given order."""
    for index in episodes:
        if not 0 <= index < len(demonstrations.episodes):
            raise UserError(f"There is no episode {index}: the dataset has {len(demonstrations.episodes)}.")
    return replace(demonstrations, episodes=tuple(demonstrations.episodes[index] for index in episodes))


FEW: Final = 3  # with at least this many training demonstrations, one is used for validation ...
MANY: Final = 8  # ... and with at least this many, two.


@dataclass(frozen=True)
class Fold:
    """One choice of the held-out episodes."""

    index: int
    held_out: tuple[int, ...]  # for evaluation only, rising
    others: tuple[int, ...]  # the rest, in the order of use where fewer are wanted

    @property
    def validation(self) -> tuple[int, ...]:
        """Episodes for early stopping; with fewer than `FEW` others, these are the training episodes."""
        if len(self.others) < FEW:
            return self.others
        return self.others[: 2 if len(self.others) >= MANY else 1]

    @property
    def training(self) -> tuple[int, ...]:
        """Episodes for fitting the weights."""
        return self.others if len(self.others) < FEW else self.others[len(self.validation) :]

    def with_only(self, demonstrations: int) -> "Fold":
        """The fold with only the first of the others, including its validation episodes."""
        return replace(self, others=self.others[:demonstrations])


def make_folds(episodes: int, count: int, rng: np.random.Generator) -> tuple[Fold, ...]:
    """Hold every episode out exactly once; ``rng`` draws the groups and the order of the others."""
    if episodes < count:
        raise UserError(
            f"It has {episodes} episodes, fewer than the {count} folds: choose fewer folds, or record more."
        )
    order = [int(index) for index in rng.permutation(episodes)]
    return tuple(_fold(index, order[index::count], order, rng) for index in range(count))


def _fold(index: int, held_out: Sequence[int], order: Sequence[int], rng: np.random.Generator) -> Fold:
    others = rng.permutation([episode for episode in order if episode not in held_out])
    return Fold(index, tuple(sorted(held_out)), tuple(int(episode) for episode in others))
