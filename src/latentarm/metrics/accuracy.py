"""Accuracy: how well encoding and decoding preserves actions (section 8.1), compared with PCA of equal d."""

from collections.abc import Sequence

import numpy as np

from latentarm.metrics.contract import DecodesActions, decode_all
from latentarm.types import FloatArray


def reconstruction_error(
    decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray, action: FloatArray
) -> FloatArray:
    """Mean squared error of ``phi(psi(c, a), c)`` against the action a.

    Args:
        decoders: S decoders.
        z: (S, N, d), the encoded actions ``psi(c, a)``.
        context: (N, c), the contexts that the actions were encoded in.
        action: (N, m), noise-free, rad/s.

    Returns:
        (S,), mean over pairs and joints, rad^2/s^2.
    """
    return np.mean((decode_all(decoders, z, context) - action) ** 2, axis=(1, 2))


def pca_error(train_action: FloatArray, action: FloatArray, latent_dim: int) -> float:
    """Mean squared error of the best plane through the training actions, the paper's baseline.

    PCA sees actions only, as they are in rad/s, so its error is the same with and without state noise.

    Args:
        train_action: (M, m), actions that the plane is fitted to, rad/s.
        action: (N, m), actions it is tested on, rad/s.
        latent_dim: number of components d.

    Returns:
        Mean over pairs and joints, rad^2/s^2.
    """
    mean = train_action.mean(axis=0)
    scatter = (train_action - mean).T @ (train_action - mean)
    directions = np.linalg.eigh(scatter)[1]
    lost = directions[:, : train_action.shape[1] - latent_dim]
    # The error is the part along the directions of least variance.
    return float(np.sum(((action - mean) @ lost) ** 2) / action.size)


def percent_of(baseline: float, error: FloatArray) -> FloatArray:
    """Errors (S,) in percent of the baseline's; NaN where the baseline has none (PCA with d = m)."""
    return 100.0 * error / baseline if baseline > 0 else np.full_like(error, np.nan)
