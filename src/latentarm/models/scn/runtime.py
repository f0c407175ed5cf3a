"""SCN without its training: sizes and the decoder ``W_2(c) tanh(W_1(c) z)`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.core.style import Look
from latentarm.core.types import FloatArray
from latentarm.models.enclosure import TANH_CURVATURE, Enclosure, celled
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import halve_hidden, layers_of, propagate, scale_context

UNITS: Final = 16
"""Hidden units k of the network of z."""


@final
class _Runtime(Runtime):
    """W_2(c) tanh(W_1(c) z) of the state-conditioned nonlinear model."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = layers_of(trained, seed)
        d, m = trained.dimensions.latent, trained.dimensions.action
        # Both scalings go into the network's last layer: its outputs are W_1, row by row, then W_2.
        scale = np.concatenate(
            [
                np.repeat(trained.latents.scale[seed, 0], UNITS),
                np.broadcast_to(trained.actions.scale, (UNITS * m,)),
            ]
        )
        weight, bias = layers[-1]
        layers[-1] = (weight * scale, bias * scale)
        first = scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        self._inputs, self._split, self._joints = d, d * UNITS, m

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """See `Runtime`."""
        first, second = self._matrices(context)
        return np.vecmat(np.tanh(np.vecmat(z, first)), second)

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`."""
        first, second = self._matrices(context)
        before = celled(first, np.zeros((*first.shape[:-2], UNITS)), fineness)
        tanh = np.tanh(before.centre)
        return before.bent(tanh, 1.0 - tanh * tanh, TANH_CURVATURE).mapped(second[..., None, :, :])

    def _matrices(self, context: FloatArray) -> tuple[FloatArray, FloatArray]:
        """W_1 (..., d, k) and W_2 (..., k, m)."""
        weights = propagate(context @ self._weight + self._bias, self._rest)
        lead = weights.shape[:-1]
        first = weights[..., : self._split].reshape(*lead, self._inputs, UNITS)
        return first, weights[..., self._split :].reshape(*lead, UNITS, self._joints)


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    outputs = UNITS * (dimensions.latent + dimensions.action)
    return {"decoder": (dimensions.context, *dimensions.hidden, outputs)}


SCN: Final = ModelKind(
    name="scn",
    look=Look("SCN", "#661100", "8", (0.0, (1.0, 1.0))),
    estimator="latentarm.models.scn.training:SCN",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="deterministic",
    rests_at_zero=True,
    reverses=True,
    advice="The scn rests and goes back; --model odd_cae does so too and had a lower error on a recording of"
    " a real arm.",
)
