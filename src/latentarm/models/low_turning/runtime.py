"""The low-turning model without its training: sizes and the decoder ``v r R(c, z / r)`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.models.homogeneous.runtime import DAMPING_M2, ORDERS, odd_degrees
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import NORM_FLOOR, halve_hidden, layers_of, propagate, scale_context
from latentarm.style import Look
from latentarm.types import FloatArray

BEND_SIZE: Final = 0.15
"""Factor of the network's bends, so that they start with about as much of the curve's length as M_1."""


@final
class _Runtime(Runtime):
    """v r R(c, z / r) with r = ‖z‖."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        layers = layers_of(trained, seed)
        first = scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        self._speed = float(trained.actions.scale[0])
        self._latents, self._joints = trained.dimensions.latent, trained.dimensions.action
        self._bend_sizes = bend_sizes(self._latents)

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """See `Runtime`."""
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        led = np.vecmat(odd_degrees(z / np.maximum(radius, NORM_FLOOR)), self._columns(context))
        twist = np.matvec(self._contexts.jacobian(context[..., : self._joints]), led)
        size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(led, led)
        return self._speed * radius * led / np.sqrt(size + NORM_FLOOR)[..., None]

    def _columns(self, context: FloatArray) -> FloatArray:
        """M_1(c) and the bends M_3(c), M_5(c), ..., each column a row, (..., (1 + orders) d, m)."""
        raw = propagate(context @ self._weight + self._bias, self._rest)
        columns = raw.reshape(*raw.shape[:-1], -1, self._joints).copy()
        columns[..., self._latents :, :] *= self._bend_sizes[:, None]
        for axis in range(self._latents):
            column = columns[..., axis, :]
            column /= np.sqrt(np.vecdot(column, column) + NORM_FLOOR)[..., None]
            after = columns[..., axis + 1 :, :]
            after -= np.matvec(after, column)[..., None] * column[..., None, :]
        return columns


def bend_sizes(latent_dim: int) -> FloatArray:
    """Factors (orders d,) of the network's bends: 1 / n for order n, which adds n times as much length."""
    return BEND_SIZE / np.repeat(np.array(ORDERS, dtype=np.float64), latent_dim)


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    outputs = (1 + len(ORDERS)) * dimensions.latent * dimensions.action
    return {"decoder": (dimensions.context, *dimensions.hidden, outputs)}


LOW_TURNING: Final = ModelKind(
    name="low_turning",
    look=Look("low turning", "#DDAA33", "x", (0.0, (8.0, 2.0))),
    estimator="latentarm.models.low_turning.training:LowTurning",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="nearest",
    rests_at_zero=True,
    reverses=True,
    damping_m2=DAMPING_M2,
    advice="The low_turning rests and goes back; where it leaves out motions that matter, try --model"
    " homogeneous, which reproduces more and turns faster.",
)
