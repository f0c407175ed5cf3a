"""The homogeneous model without its training: sizes and the decoder ``v r R(c, z / r)`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import NORM_FLOOR, halve_hidden, layers_of, propagate, scale_context
from latentarm.style import Look
from latentarm.types import FloatArray

DAMPING_M2: Final = 1e-3
ORDERS: Final = (3, 5, 7)
"""Odd degrees by which the model bends."""

BEND_SIZE: Final = 0.3
"""Factor of the network's bends, so that they start small."""


@final
class _Runtime(Runtime):
    """‖z‖ R(c, z / ‖z‖) of the homogeneous model."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        layers = layers_of(trained, seed)
        first = scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        self._speed = float(trained.actions.scale[0])
        self._latents, self._joints = trained.dimensions.latent, trained.dimensions.action

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        jacobian = self._contexts.jacobian(context[..., : self._joints])
        columns = self._columns(context, jacobian)
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        led = np.matvec(columns, odd_degrees(z / np.maximum(radius, NORM_FLOOR)))
        twist = np.matvec(jacobian, led)
        size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(led, led)
        return self._speed * radius * led / np.sqrt(size + NORM_FLOOR)[..., None]

    def _columns(self, context: FloatArray, jacobian: FloatArray) -> FloatArray:
        """M_1(c) and the bends M_3(c), M_5(c), ..., (..., m, (1 + orders) d)."""
        raw = propagate(context @ self._weight + self._bias, self._rest)
        columns = raw.reshape(*raw.shape[:-1], -1, self._joints).swapaxes(-1, -2).copy()
        columns[..., self._latents :] *= BEND_SIZE
        twists = jacobian @ columns
        for axis in range(self._latents):
            column, twist = columns[..., axis], twists[..., axis]
            size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(column, column)
            scale = 1 / np.sqrt(size + NORM_FLOOR)[..., None]
            column *= scale
            twist *= scale
            after, after_twist = columns[..., axis + 1 :], twists[..., axis + 1 :]
            along = np.vecmat(twist, after_twist) + self._contexts.damping * np.vecmat(column, after)
            after -= column[..., None] * along[..., None, :]
            after_twist -= twist[..., None] * along[..., None, :]
        return columns


def odd_degrees(direction: FloatArray) -> FloatArray:
    """Chebyshev polynomials ``T_n`` of each entry for n = 1 and `ORDERS`, (..., d) to (..., (1 + orders) d).

    For d = 2 and a direction at the angle theta these are cos(n theta) and, but for the sign, sin(n theta).
    """
    twice = 4 * np.square(direction) - 2
    before, degree, parts = direction, direction, [direction]
    for _ in ORDERS:
        before, degree = degree, twice * degree - before
        parts.append(degree)
    return np.concatenate(parts, axis=-1)


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    outputs = (1 + len(ORDERS)) * dimensions.latent * dimensions.action
    return {"decoder": (dimensions.context, *dimensions.hidden, outputs)}


HOMOGENEOUS: Final = ModelKind(
    name="homogeneous",
    look=Look("homogeneous", "#882255", "h", (0.0, (4.0, 1.0, 1.0, 1.0))),
    estimator="latentarm.models.homogeneous.training:Homogeneous",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="nearest",
    rests_at_zero=True,
    reverses=True,
    damping_m2=DAMPING_M2,
    advice="The homogeneous rests and goes back; where its motions turn too fast for the stick, try the"
    " plainer --model scl.",
)
