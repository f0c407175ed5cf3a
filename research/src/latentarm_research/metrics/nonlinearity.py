"""Nonlinearity: how much of a decoder's motion over the stick's range no linear map of the stick gives.

Przystupa et al. (Investigating the Benefits of Nonlinear Action Maps in Data-Driven Teleoperation, 2024,
arXiv 2410.21406) find that action maps that are odd, but not linear by construction, are nearly linear over
most of the range of the input. We have the finding, not the paper's definition; this one is ours.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions

DIRECTIONS: Final = 12
RADII: Final = (1 / 3, 2 / 3, 1.0)
"""The stick is pushed in so many directions, evenly spaced, by each of these amounts."""


def nonlinearity(
    decoders: Sequence[DecodesActions],
    context: FloatArray,  # (N, c)
) -> FloatArray:
    """Share of the motion's variance over the stick's range that is not linear in z, in every context.

    The motion at rest does not count: drift has it.

    Returns:
        (S, N), 0 for a map that is linear but for an offset, at most 1; NaN where nothing changes with z.

    Raises:
        ValueError: a latent space has other than two axes.
    """
    if any(decoder.latent_dim != 2 for decoder in decoders):
        raise ValueError("A stick that is pushed in all directions has two axes.")
    angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    z = np.concatenate([radius * around for radius in RADII])
    action = np.stack(
        [
            decoder.decode(np.broadcast_to(z, (len(context), *z.shape)), context[:, None])
            for decoder in decoders
        ]
    )
    varies = action - action.mean(axis=-2, keepdims=True)
    left = varies - z @ (np.linalg.pinv(z) @ varies)
    total = np.square(varies).sum(axis=(-2, -1))
    return np.divide(
        np.square(left).sum(axis=(-2, -1)), total, out=np.full_like(total, np.nan), where=total > 0
    )
