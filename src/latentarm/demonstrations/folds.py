"""Which episodes train, which validate (stop the training early), and which are held out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from latentarm.errors import UserError

FEW: Final = 3
"""With at least this many training demonstrations, one is used for validation ..."""

MANY: Final = 8
"""... and with at least this many, two."""


@dataclass(frozen=True)
class Fold:
    """One choice of the held-out episodes.

    Attributes:
        index: which of the folds.
        held_out: episodes that nothing is fitted to, rising.
        others: all further ones, in the order in which they are taken where fewer are wanted.
    """

    index: int
    held_out: tuple[int, ...]
    others: tuple[int, ...]

    @property
    def validation(self) -> tuple[int, ...]:
        """Validation episodes, which stop the training early.

        With fewer than `FEW` there are none to spare, and training stops when its own loss stops falling.
        """
        if len(self.others) < FEW:
            return self.others
        return self.others[: 2 if len(self.others) >= MANY else 1]

    @property
    def training(self) -> tuple[int, ...]:
        """Episodes that the weights are fitted to."""
        return self.others if len(self.others) < FEW else self.others[len(self.validation) :]

    def with_only(self, demonstrations: int) -> "Fold":
        """The same fold with only the first of the others, the validation episodes among them."""
        return replace(self, others=self.others[:demonstrations])


def make_folds(episodes: int, count: int, rng: np.random.Generator) -> tuple[Fold, ...]:
    """Hold every episode out exactly once.

    Args:
        episodes: of the dataset.
        count: number of folds.
        rng: which episodes go together, and in which order the others are taken.

    Raises:
        UserError: there are fewer episodes than folds.
    """
    if episodes < count:
        raise UserError(
            f"It has {episodes} episodes, fewer than the {count} folds: choose fewer folds, or record more."
        )
    order = [int(index) for index in rng.permutation(episodes)]
    return tuple(_fold(index, order[index::count], order, rng) for index in range(count))


def _fold(index: int, held_out: Sequence[int], order: Sequence[int], rng: np.random.Generator) -> Fold:
    others = rng.permutation([episode for episode in order if episode not in held_out])
    return Fold(index, tuple(sorted(held_out)), tuple(int(episode) for episode in others))
