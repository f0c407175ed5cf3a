"""The homogeneous model without its training: sizes and the decoder ``v r R(c, z / r)`` in NumPy."""

from abc import ABC, abstractmethod
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure, linear_enclosure
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import NORM_FLOOR, halve_hidden, layers_of, propagate, scale_context

DAMPING_M2: Final = 1e-3
ORDERS: Final = (3, 5, 7)  # odd degrees by which the model bends
BEND_SIZE: Final = 0.3  # factor of the network's bends, so that they start small
CELLS: Final = 64
"""Cells that half of all directions are cut into for the enclosure; 45 degrees lie between two of them."""


class CurveDecoder(Runtime, ABC):
    """v r R(c, z / r) with r = ‖z‖, for columns of R that a network of the context gives."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        layers = layers_of(trained, seed)
        first = scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        self._speed = float(trained.actions.scale[0])
        self._latents, self._joints = trained.dimensions.latent, trained.dimensions.action

    @abstractmethod
    def _columns(self, context: FloatArray, jacobian: FloatArray) -> FloatArray:
        """M_1(c) and the bends M_3(c), M_5(c), ..., (..., m, (1 + orders) d)."""

    @final
    def _raw_columns(self, context: FloatArray) -> FloatArray:
        """The network's output in this shape."""
        raw = propagate(context @ self._weight + self._bias, self._rest)
        return raw.reshape(*raw.shape[:-1], -1, self._joints).swapaxes(-1, -2).copy()

    @final
    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        jacobian = self._contexts.jacobian(context[..., : self._joints])
        columns = self._columns(context, jacobian)
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        led = np.matvec(columns, odd_degrees(z / np.maximum(radius, NORM_FLOOR)))
        twist = np.matvec(jacobian, led)
        size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(led, led)
        return self._speed * radius * led / np.sqrt(size + NORM_FLOOR)[..., None]

    @final
    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`; exact for d = 1, cells of the input's angle for d = 2, the metric's bound beyond.

        ``‖phi‖_G <= v ‖z‖``, so by Cauchy and Schwarz in the metric ``|phi_j| <= v ‖z‖ sqrt((G^-1)_jj)``.
        That is loose where hardly any tool shows a joint's motion.
        """
        jacobian = self._contexts.jacobian(context[..., : self._joints])
        if self._latents == 1:
            full = self(np.ones(1), context)
            return linear_enclosure(full[..., None, :], np.zeros(full.shape))
        if self._latents == 2:
            return self._enclosed_by_angle(self._columns(context, jacobian), jacobian, fineness * CELLS)
        metric = jacobian.mT @ jacobian + self._contexts.damping * np.eye(self._joints)
        most = np.sqrt(np.linalg.inv(metric).diagonal(axis1=-2, axis2=-1))[..., None, :]
        rest = self._speed * np.sqrt(self._latents) * most
        return Enclosure(np.zeros(rest.shape), np.zeros((*rest.shape[:-1], 0, self._joints)), rest)

    def _enclosed_by_angle(self, columns: FloatArray, jacobian: FloatArray, cells: int) -> Enclosure:
        """The enclosure for d = 2, in cells of the angle theta of z with a half width w.

        The direction that is brought to unit length, ``led(theta)``, is a sum of columns times cos(n theta)
        or sin(n theta): within a cell it is ``led_c + δ w led'_c`` up to ``w² / 2 Σ n² |column|``. What it
        is divided by, its length in the metric, is at least that of the nearest point of this line less the
        remainder's. The input is at most as long as the square reaches, and may have either sign.
        """
        width = np.pi / (2 * cells)
        ends = np.pi / cells * np.arange(cells + 1)
        degrees = np.repeat((1, *ORDERS), 2)
        phases = np.stack(np.broadcast_arrays(ends[:-1] + width, 0.5 * np.pi - ends[:-1] - width), -1)
        phase = degrees * phases[:, np.arange(len(degrees)) % 2]
        signs = np.where(np.arange(len(degrees)) % 2, 1.0, -1.0)
        wave, slope = np.cos(phase), signs * degrees * np.sin(phase)
        twists = jacobian @ columns
        led, turned = wave @ columns.mT, width * slope @ columns.mT
        led_twist, turned_twist = wave @ twists.mT, width * slope @ twists.mT
        left = 0.5 * width**2 * np.square(degrees)

        def inner(a: FloatArray, a_twist: FloatArray, b: FloatArray, b_twist: FloatArray) -> FloatArray:
            return np.vecdot(a_twist, b_twist) + self._contexts.damping * np.vecdot(a, b)

        along = inner(led, led_twist, turned, turned_twist)
        turning = inner(turned, turned_twist, turned, turned_twist)
        nearest = np.clip(-along / (turning + NORM_FLOOR), -1.0, 1.0)[..., None]
        closest, closest_twist = led + nearest * turned, led_twist + nearest * turned_twist
        lengths = np.sqrt(inner(columns.mT, twists.mT, columns.mT, twists.mT)) @ left
        least = np.sqrt(inner(closest, closest_twist, closest, closest_twist)) - lengths[..., None]
        size = np.sqrt(np.square(np.maximum(least, 0.0)) + NORM_FLOOR)
        reach = np.maximum(np.abs(np.cos(ends)), np.abs(np.sin(ends)))
        longest = 1.0 / np.minimum(reach[:-1], reach[1:])
        factor = (self._speed * longest / size)[..., None]
        remainder = factor * np.matvec(np.abs(columns), left)[..., None, :]
        spread = factor[..., None] * np.stack([led, turned], axis=-2)
        return Enclosure(np.zeros(remainder.shape), spread, remainder)


@final
class _Runtime(CurveDecoder):
    """Columns that are orthogonal in the metric of the tools."""

    def _columns(self, context: FloatArray, jacobian: FloatArray) -> FloatArray:
        columns = self._raw_columns(context)
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


def curve_sizes(dimensions: Dimensions) -> dict[str, Shape]:
    """Layers of the network that gives the columns of a `CurveDecoder`."""
    outputs = (1 + len(ORDERS)) * dimensions.latent * dimensions.action
    return {"decoder": (dimensions.context, *dimensions.hidden, outputs)}


HOMOGENEOUS: Final = ModelKind(
    name="homogeneous",
    label="homogeneous",
    estimator="latentarm.models.homogeneous.training:Homogeneous",
    runtime=_Runtime,
    decoder=curve_sizes,
    encoder="nearest",
    rests_at_zero=True,
    reverses=True,
    damping_m2=DAMPING_M2,
    way_back_m=0.06,
    advice="The homogeneous suits a driver who knows what each push does: its motions turn several times as"
    " fast as the stick. For one who is still learning that, try --model low_turning or --model scl.",
)
