"""Drift: how fast the arm moves while the input is at rest."""

from collections.abc import Sequence

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions, decode_all, zero_latent


def drift(decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray) -> FloatArray:
    """Mean ‖phi(0, c)‖ over mean ‖phi(z, c)‖, (S,); NaN where no z moves the arm at all.

    0 is an arm that rests with the input; 1 moves as fast on its own as the person made it move. ``z`` (S, N,
    d) are latent actions that the demonstrations use (encoded held-out actions) in contexts (N, c).
    """
    moved = np.linalg.norm(decode_all(decoders, z, context), axis=-1).mean(axis=1)
    rest = np.stack([decoder.decode(zero_latent(decoder, context), context) for decoder in decoders])
    drifted = np.linalg.norm(rest, axis=-1).mean(axis=1)
    return np.divide(drifted, moved, out=np.full_like(moved, np.nan), where=moved > 0)
