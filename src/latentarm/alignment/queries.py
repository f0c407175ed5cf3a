"""Which motion to ask about next, and when to stop.

The next motion is the one least like all before it; asking stops when an ensemble of alignments agrees. In
the study of section 8.3 this teaches more than to ask where the ensemble disagrees most (docs/alignment.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment
from latentarm.alignment.error import lengths, outcome
from latentarm.alignment.poses import pose_vectors
from latentarm.errors import UserError
from latentarm.kinematics.chain import Chain
from latentarm.models.kind import Decoder
from latentarm.types import FloatArray

TOO_FEW: Final = 3
"""Answers below which alignments agree or disagree by chance."""

ENSEMBLE: Final = 5
"""Alignments that disagree, and of which the best is kept in the end."""

PLACE_WEIGHT: Final = 0.5
"""Weight of a motion's place relative to its direction when motions are compared."""

INPUTS_TRIED: Final = 200
"""Inputs, at most, that are tried to find the one that an alignment would want for a motion."""


def bootstrap(answers: Answers, count: int, rng: np.random.Generator) -> list[Answers]:
    """Bootstrap samples of the answers, one for each alignment of an ensemble.

    Alignments that differ only in their initial weights agree long before they are right, so each of these
    is also trained on different answers.

    Args:
        answers: N.
        count: how many times to draw.
        rng: source of the draws.
    """
    return [answers[rng.integers(0, len(answers), len(answers))] for _ in range(count)]


def disagreement(
    alignments: Sequence[Alignment], decoder: Decoder, chain: Chain, motions: Motions
) -> FloatArray:
    """How much an ensemble disagrees about the motion that the answer would cause.

    Each alignment i has an input u_i that comes nearest to the motion. Were the answer u_j, as another one
    expects, alignment i would lead to Psi(T_i(s, u_j)) where it wants Psi(T_i(s, u_i)): the root mean square
    distance between the two, over all i and j, is the disagreement. It is one of the tool's motions, so that
    inputs that do the same count as the same.

    Args:
        alignments: S of them.
        decoder: phi.
        chain: the arm.
        motions: N.

    Returns:
        (N,), m, see `pose_vectors`.
    """
    inputs = _grid(decoder.latent_dim)
    tried = np.broadcast_to(inputs[:, None], (len(inputs), len(motions), decoder.latent_dim))
    led = np.stack([outcome(alignment, decoder, chain, motions, tried) for alignment in alignments])
    wanted = np.square(led - pose_vectors(chain, motions.end)).sum(-1).argmin(axis=1)  # (S, N)
    each, motion = np.arange(len(alignments)), np.arange(len(motions))
    # (i, j, N, p): where alignment i leads with the input that j wants.
    crossed = led[each[:, None, None], wanted[None], motion]
    own = led[each[:, None], wanted, motion]
    return np.sqrt(np.square(crossed - own[:, None]).sum(-1).mean(axis=(0, 1)))


def novelty(chain: Chain, motions: Motions, asked: Sequence[int]) -> FloatArray:
    """How different each motion is from all that were asked about.

    Motions are alike where they begin in like poses and lead the same way, or the opposite way: what pushes
    back is known from what pushes. To ask about the least alike, again and again, is the greedy k-centre
    choice (Gonzalez 1985; as active learning, Sener & Savarese 2018).

    Args:
        chain: the arm.
        motions: N.
        asked: rows of those that were asked about.

    Returns:
        (N,), without units: the distance to the nearest one; while none was asked about, the length.
    """
    place = pose_vectors(chain, motions.start)
    way = pose_vectors(chain, motions.end) - place
    place = PLACE_WEIGHT * _scaled(place - place.mean(axis=0))
    way = _scaled(way)
    if not asked:
        return np.linalg.norm(way, axis=-1)
    there = np.square(place[:, None] - place[asked]).sum(axis=-1)
    alike = np.square(way[:, None] - way[asked]).sum(axis=-1)
    opposite = np.square(way[:, None] + way[asked]).sum(axis=-1)
    return np.sqrt(there + np.minimum(alike, opposite)).min(axis=1)


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
        share: enough is known where the ensemble disagrees by less than this share of a motion's length,
            root mean square over the motions.
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
            history: the disagreement after each answer so far, as a share of a motion's length.
        """
        if history and history[-1] < self.share:
            return True
        earlier, recent = history[: -self.patience], history[-self.patience :]
        return bool(earlier) and min(recent) > (1 - self.fall) * min(earlier)


def disagreement_share(apart: FloatArray, chain: Chain, motions: Motions) -> float:
    """Disagreement (N,) about motions as a share of their length, both root mean square."""
    return float(np.sqrt(np.square(apart).mean() / np.square(lengths(chain, motions)).mean()))


def _scaled(vectors: FloatArray) -> FloatArray:
    """Vectors (N, p) in the root mean square of their lengths; zeros stay what they are."""
    scale = np.sqrt(np.square(vectors).sum(axis=-1).mean())
    return vectors / scale if scale > 0 else vectors


def _grid(axes: int) -> FloatArray:
    """Inputs (K, d) evenly over [-1, 1]^d, with zero among them."""
    per_axis = max(3, int(INPUTS_TRIED ** (1 / axes)))
    values = np.linspace(-1, 1, min(per_axis - 1 + per_axis % 2, 41))
    return np.stack(np.meshgrid(*[values] * axes, indexing="ij"), axis=-1).reshape(-1, axes)
