"""Reversal: how much of a motion remains after the opposite input."""

from collections.abc import Sequence

import numpy as np

from latentarm.metrics.contract import DecodesActions, next_context
from latentarm.types import FloatArray


def reversal(
    decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray, step_s: float
) -> FloatArray:
    """Mean ‖s2 - s0‖ over mean ‖s1 - s0‖, with s1 = T(s0, phi(z, s0)) and s2 = T(s1, phi(-z, s1)).

    The two means are taken before the ratio, so that states in which z hardly moves the arm do not dominate.
    0 is a motion fully undone; 1 leaves as far to go back as the motion was long; 2 is a decoder that
    ignores the sign of z.

    Args:
        decoders: S decoders.
        z: (S, N, d), latent actions that the demonstrations use (encoded held-out actions).
        context: (N, c), contexts of s0.
        step_s: how long each of z and -z is held, s.

    Returns:
        (S,), a ratio; NaN where no z moves the arm at all.
    """
    left = np.full(len(decoders), np.nan)
    for seed, (decoder, latent) in enumerate(zip(decoders, z, strict=True)):
        forth = decoder.decode(latent, context)
        back = decoder.decode(-latent, next_context(context, forth, step_s))
        moved = np.linalg.norm(forth, axis=-1).mean()
        if moved > 0:
            left[seed] = np.linalg.norm(forth + back, axis=-1).mean() / moved
    return left
