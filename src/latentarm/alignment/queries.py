"""Which motion to ask about next, and when to stop.

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

TOO_FEW: Final = 2
"""Answers after which asking may stop."""

LENGTH_M: Final = 0.3
"""Distance over which the meaning of an input may change with the place, when questions are chosen."""

VARIATION: Final = 0.1
"""Coefficient of variation of the answers, when questions are chosen."""


@final
class Design:
    """How much each motion would teach.

    Args:
        motions: N, that may be asked about.
    """

    def __init__(self, chain: Chain, motions: Motions) -> None:
        place, twist = pose_vectors(chain, motions.start), motion_twists(chain, motions)
        apart = np.square(place[:, None] - place).sum(axis=-1)
        prior = (twist @ twist.T) * (1.0 + np.exp(-0.5 * apart / LENGTH_M**2))
        self._prior = prior / max(float(np.diag(prior).mean()), 1e-12)

    def worth(self, asked: Sequence[int]) -> FloatArray:
        """By how much an answer about each motion lowers the mean variance over all.

        Active learning by expected variance (Cohn 1996).

        Returns:
            (N,), as a share of the mean variance before the first answer.
        """
        variance = self._prior
        noise = VARIATION**2 * (np.diag(self._prior) + 1.0)
        for row in asked:
            column = variance[:, row]
            variance = variance - np.outer(column, column) / (column[row] + noise[row])
        return np.square(variance).mean(axis=0) / (np.diag(variance) + noise)


def next_motion(worth: FloatArray, asked: Sequence[int]) -> int:
    """The motion that is worth most (N,), of those not yet asked about.

    Raises:
        UserError: all have been asked about.
    """
    if len(set(asked)) >= len(worth):
        raise UserError(f"All {len(worth)} motions have been asked about.")
    left = worth.copy()
    left[list(asked)] = -np.inf
    return int(left.argmax())


@final
@dataclass(frozen=True)
class StoppingRule:
    """When to stop asking.

    Attributes:
        share: enough is known where less than this share of the inputs is unknown (`Posterior.share`).
        fall: nor is anything learned where ``patience`` answers have not lowered it by this share.
        patience: answers.

    Raises:
        UserError: a figure is out of its range.
    """

    share: float = 0.1
    fall: float = 0.05
    patience: int = 3

    def __post_init__(self) -> None:
        for name in ("share", "fall"):
            if not 0 <= getattr(self, name) <= 1:
                raise UserError(f"The stopping rule's {name} must be within 0 and 1.")
        if self.patience < 1:
            raise UserError("The stopping rule waits for at least one answer.")

    def enough(self, history: Sequence[float]) -> bool:
        """Whether to stop asking.

        Args:
            history: the share that was unknown after each answer so far.
        """
        if history and history[-1] < self.share:
            return True
        earlier, recent = history[: -self.patience], history[-self.patience :]
        return bool(earlier) and min(recent) > (1 - self.fall) * min(earlier)


def order_of_questions(chain: Chain, motions: Motions, most: int) -> list[int]:
    """Rows of the motions to ask about, in the order of asking; no answer changes it.

    Args:
        chain: the arm.
        motions: that may be asked about.
        most: how many, at most as many as there are motions.
    """
    design, asked = Design(chain, motions), list[int]()
    while len(asked) < most:
        asked.append(next_motion(design.worth(asked), asked))
    return asked
