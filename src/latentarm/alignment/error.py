"""The error of an alignment relative to the person's meaning."""

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment
from latentarm.alignment.poses import pose_vectors
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.chain import Chain


def outcome(
    alignment: Alignment, decoder: Decoder, chain: Chain, motions: Motions, u: FloatArray
) -> FloatArray:
    """Poses ``Psi(T(s, u))`` (..., N, 12 k), m, that inputs (..., N, d) lead to from the starts of motions.

    See `pose_vectors`. The inputs are held for as long as the motions take.
    """
    context = motions.context
    action = decoder.decode(alignment(u, context), context)
    return pose_vectors(chain, motions.start + motions.duration_s * action)


def lengths(chain: Chain, motions: Motions) -> FloatArray:
    """The distance of each motion (N,), m; turns of the tools count, see `pose_vectors`."""
    step = pose_vectors(chain, motions.end) - pose_vectors(chain, motions.start)
    return np.linalg.norm(step, axis=-1)


def relative_alignment_error(alignment: Alignment, decoder: Decoder, chain: Chain, answers: Answers) -> float:
    """``‖x* - x^(t+1)‖^2 / ‖x* - x^t‖^2`` (section 8.3), each averaged over all motions.

    0 where every motion is met, 1 for an arm that does not move. A mean of ratios would be that of the few
    motions that hardly move.
    """
    reached = outcome(alignment, decoder, chain, answers.motions, answers.u)
    missed = reached - pose_vectors(chain, answers.motions.end)
    return float(np.square(missed).sum() / np.square(lengths(chain, answers.motions)).sum())
