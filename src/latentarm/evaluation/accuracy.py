"""Accuracy: how well encoding and decoding preserve actions (section 8.1), compared with PCA of equal d.

There are two ways to encode. Section 8.1 measures the encoder network, of models that have one. The nearest
input in the range of a person's stick (`latentarm.evaluation.search`) tells what the decoder can express, and
works alike for every model. Nobody needs an encoder to drive, so that figure counts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from latentarm.core.types import FloatArray, Pairs
from latentarm.evaluation.contract import DecodesActions, decode_all
from latentarm.evaluation.samples import evenly_spread
from latentarm.evaluation.search import nearest_latents

if TYPE_CHECKING:
    from latentarm.models.model import LatentActionModel


def reconstruction_error(
    decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray, action: FloatArray
) -> FloatArray:
    """Mean squared error (S,) of ``phi(psi(c, a), c)`` against the action a, rad^2/s^2.

    ``z`` is psi(c, a), (S, N, d); contexts are (N, c), actions (N, m), noise-free, rad/s.
    """
    return np.mean((decode_all(decoders, z, context) - action) ** 2, axis=(1, 2))


def pca_error(train_action: FloatArray, action: FloatArray, latent_dim: int) -> float:
    """Mean squared error of the best plane through (M, m) training actions on (N, m) others, rad^2/s^2.

    This is the paper's baseline. PCA sees actions only, as they are in rad/s, so its error is the same with
    and without state noise.
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


@dataclass(frozen=True)
class Accuracy:
    """Errors of S seeds, and intermediate results for the other measures."""

    figures: Mapping[str, FloatArray]  # measure -> (S,); NaN for an encoder network that the model lacks
    decoders: Sequence[DecodesActions]
    z: FloatArray  # (S, L, d), the nearest inputs without noise, for the pairs that were searched for
    context: FloatArray  # (L, c), their contexts
    action: FloatArray  # (L, m), the actions there, rad/s


def accuracy(model: "LatentActionModel", train_action: FloatArray, pairs: Pairs, searched: int) -> Accuracy:
    """Errors with both ways of encoding, with noise on the states and without.

    PCA, the baseline, is fitted to ``train_action`` (M, m), rad/s. All held-out pairs go through an encoder
    network; for ``searched`` of them, spread evenly, the nearest input is searched, and PCA's error is taken
    on the same ones.
    """
    chosen = evenly_spread(searched, len(pairs.action))
    action = pairs.action[chosen]
    clean_codes, noisy_codes = (
        model.encode(context, pairs.action) for context in (pairs.clean_context, pairs.context)
    )
    decoders = [model.decoder(seed) for seed in range(len(clean_codes))]
    baseline, baseline_of_chosen = (
        pca_error(train_action, of, clean_codes.shape[-1]) for of in (pairs.action, action)
    )
    figures: dict[str, FloatArray] = {}
    nearest = np.zeros((0, 0, 0))
    for name, context, codes in (
        ("error", pairs.context, noisy_codes),
        ("noise_free_error", pairs.clean_context, clean_codes),
    ):
        nearest = nearest_latents(decoders, context[chosen], action, codes[:, chosen])
        expressed = reconstruction_error(decoders, nearest, context[chosen], action)
        encoded = np.full_like(expressed, np.nan)
        if model.learns_encoder:
            encoded = reconstruction_error(decoders, codes, context, pairs.action)
        figures |= {
            f"search_{name}": expressed,
            f"search_{name}_percent_of_pca": percent_of(baseline_of_chosen, expressed),
            name: encoded,
            f"{name}_percent_of_pca": percent_of(baseline, encoded),
        }
    return Accuracy(figures, decoders, nearest, pairs.clean_context[chosen], action)
