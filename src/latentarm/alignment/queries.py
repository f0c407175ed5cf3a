"""The choice of the next motion to ask about, and of the end of asking.

A person's meaning is a Gaussian process on ``u = Q(c) dx`` with the kernel ``dx . dx' [1 + RBF(x, x')]``. Its
variance does not depend on the answers: it says before the first one which motion teaches most.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.twists import motion_twists
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain

FEWEST: Final = 6
"""Answers to learn from at least: with fewer, what is learned from all but one says nothing of that one."""
LENGTH_M: Final = 0.3
"""Distance over which the meaning of an input may change with the place, when questions are chosen."""

VARIATION: Final = 0.1  # coefficient of variation of the answers, when questions are chosen


@final
class QuestionDesign:
    """The value of an answer about each of N motions."""

    def __init__(self, chain: Chain, motions: Motions) -> None:
        place, twist = pose_vectors(chain, motions.start), motion_twists(chain, motions)
        apart = np.square(place[:, None] - place).sum(axis=-1)
        prior = (twist @ twist.T) * (1.0 + np.exp(-0.5 * apart / LENGTH_M**2))
        self._prior = prior / max(float(np.diag(prior).mean()), 1e-12)

    def worth(self, asked: Sequence[int]) -> FloatArray:
        """The share (N,) of the mean variance over all motions that an answer about each would take away.

        Active learning by expected variance (Cohn 1996), relative to the variance before the first answer.
        """
        variance = self._prior
        noise = VARIATION**2 * (np.diag(self._prior) + 1.0)
        for row in asked:
            column = variance[:, row]
            variance = variance - np.outer(column, column) / (column[row] + noise[row])
        return np.square(variance).mean(axis=0) / (np.diag(variance) + noise)


def next_motion(worth: FloatArray, asked: Sequence[int]) -> int:
    """The motion of the largest worth (N,) not yet asked about; UserError where none is left."""
    if len(set(asked)) >= len(worth):
        raise UserError(f"All {len(worth)} motions have been asked about.")
    left = worth.copy()
    left[list(asked)] = -np.inf
    return int(left.argmax())


@final
@dataclass(frozen=True)
class StoppingRule:
    """A rule for when to stop asking; UserError where a figure is out of its range."""

    share: float = 0.1  # enough is known below this share of unknown inputs (`Posterior.share`)
    fall: float = 0.05  # or where ``patience`` answers have not lowered it by this share
    patience: int = 3

    def __post_init__(self) -> None:
        for name in ("share", "fall"):
            if not 0 <= getattr(self, name) <= 1:
                raise UserError(f"The stopping rule's {name} must be within 0 and 1.")
        if self.patience < 1:
            raise UserError("The stopping rule waits for at least one answer.")

    def enough(self, history: Sequence[float]) -> bool:
        """Whether to stop asking, by the unknown share after each answer so far."""
        if history and history[-1] < self.share:
            return True
        earlier, recent = history[: -self.patience], history[-self.patience :]
        return bool(earlier) and min(recent) > (1 - self.fall) * min(earlier)


def order_of_questions(chain: Chain, motions: Motions, most: int) -> list[int]:
    """Rows of at most ``most`` motions in the order of asking; no answer changes it."""
    design, asked = QuestionDesign(chain, motions), list[int]()
    while len(asked) < most:
        asked.append(next_motion(design.worth(asked), asked))
    return asked
