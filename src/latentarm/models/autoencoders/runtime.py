"""The autoencoders without their training.

In all of them the encoder psi(c, a) sees context and action; only the decoder is conditioned or not.
"""

from dataclasses import replace
from typing import Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure, network_enclosure
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import (
    halve_hidden,
    layers_of,
    propagate,
    scale_context,
    scale_latent,
    scale_output,
)


@final
class NetworkDecoder(Runtime):
    """phi(z, c) of a network, or phi(z) where the context has no weight."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = scale_output(layers_of(trained, seed), trained.actions.scale)
        d = trained.dimensions.latent
        weight, bias = layers[0]
        # Two products instead of one over (z, c) joined: cheaper than joining, and they broadcast.
        from_latent, bias = scale_latent((weight[:d], bias), trained, seed)
        from_context = np.zeros((trained.dimensions.context, len(bias)))
        if trained.kind.sees_context:
            from_context, bias = scale_context((weight[d:], bias), trained)
        weight = np.concatenate([from_latent, from_context])
        (weight, self._bias), *self._rest = halve_hidden([(weight, bias), *layers[1:]])
        self._from_latent, self._from_context = weight[:d].copy(), weight[d:].copy()

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        first = z @ self._from_latent + (context @ self._from_context + self._bias)
        return propagate(first, self._rest)

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        offset = context @ self._from_context + self._bias
        return network_enclosure(self._from_latent, offset, self._rest, fineness)


def _latent_sizes(dimensions: Dimensions) -> dict[str, Shape]:
    return {"decoder": (dimensions.latent, *dimensions.hidden, dimensions.action)}


def conditioned_sizes(dimensions: Dimensions) -> dict[str, Shape]:
    """Layer widths of a decoder that takes (z, c)."""
    seen = dimensions.latent + dimensions.context
    return {"decoder": (seen, *dimensions.hidden, dimensions.action)}


_MOVES: Final = (
    "The {name} may move with the stick at rest and need not go back when it is pressed back; for rest and"
    " reversal by construction try --model homogeneous, or the plainer --model scl."
)
_TRAINING: Final = "latentarm.models.autoencoders.training"


def _like(base: ModelKind, name: str, label: str, training: str, **others: Any) -> ModelKind:
    """A kind like another but for these fields, trained by a class of `_TRAINING`."""
    fields = {"advice": _MOVES.format(name=name), **others}
    return replace(base, name=name, label=label, estimator=f"{_TRAINING}:{training}", **fields)


AE: Final = ModelKind(
    name="ae",
    label="AE",
    estimator=f"{_TRAINING}:AE",
    runtime=NetworkDecoder,
    decoder=_latent_sizes,
    encoder="deterministic",
    sees_context=False,
    advice=_MOVES.format(name="ae"),
)
VAE: Final = _like(AE, "vae", "VAE", "VAE", encoder="gaussian")
CAE: Final = ModelKind(
    name="cae",
    label="cAE",
    estimator=f"{_TRAINING}:CAE",
    runtime=NetworkDecoder,
    decoder=conditioned_sizes,
    encoder="deterministic",
    advice=_MOVES.format(name="cae"),
)
CVAE: Final = _like(CAE, "cvae", "cVAE", "CVAE", encoder="gaussian")
CAE_ZERO: Final = _like(
    CAE,
    "cae_zero",
    "cAE, zero penalty",
    "CAEZero",
    rests_at_zero=True,
    advice="The cae_zero nearly rests but need not go back when the stick is pressed back; for both by"
    " construction try --model homogeneous, or the plainer --model scl.",
)
CAE_REVERSAL: Final = _like(
    CAE,
    "cae_reversal",
    "cAE, reversal penalty",
    "CAEReversal",
    rests_at_zero=True,
    advice="The cae_reversal nearly rests and nearly goes back when the stick is pressed back; for both by"
    " construction try --model odd_cae or --model homogeneous.",
)
CAE_JACOBIAN: Final = _like(CAE, "cae_jacobian", "cAE, Jacobian penalty", "CAEJacobian")
CVAE_JACOBIAN: Final = _like(CVAE, "cvae_jacobian", "cVAE, Jacobian penalty", "CVAEJacobian")
