"""Proven enclosures of a decoder over all inputs (Taylor models of first order).

Sampling does not bound a decoder: between two samples it may do more. Here all inputs ``Z = [-1, 1]^d`` are
cut into cells, and in each cell k the decoder is an affine map with a remainder::

    |phi(z, c) - centre_k - Σ_i δ_i spread_k,i| <= remainder_k    for some δ in [-1, 1]^g, entry by entry

An affine map on a box takes its largest norm at a corner, so `Enclosure.largest` is an upper bound of
``‖phi‖``, and `Enclosure.furthest` one of ``w·phi`` for a given w. Both are exact where the decoder is
linear.

How the remainder of a network follows, with ``s(h) = h + h tanh h``, which is SiLU of 2 h: where the
pre-activation is ``h_c + J δ`` up to ``e``, it lies within ``r = Σ|J| + e`` of ``h_c``. By Taylor's theorem
its activation is then ``s(h_c) + s'(h_c) J δ`` up to ``|s'(h_c)| e + C r² / 2``, with ``C`` the largest
``|s''|`` in between (`curvature`). A linear map acts on centre and spread as on any vector, and on the
remainder by its absolute entries. Makino and Berz, "Taylor models and other validated functional inclusion
methods", 2003.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final, Self, final

import numpy as np

from latentarm.core.types import FloatArray

ROUNDING: Final = 1e-9  # relative margin for rounding, many times that of float64 in networks of these sizes
CELLS_PER_AXIS: Final = {1: 16, 2: 8, 3: 4}
"""Cells along each axis of z, by d, as many as a control loop has time for. One cell in larger spaces."""

MOST_CORNERS_OF: Final = 6
"""Up to this many spreads, all 2^g corners are tried; for more their lengths are added."""

TURNING_POINT: Final = 1.19967
"""Just below where s'' = 2 sech² h (1 - h tanh h) changes its sign. Up to there it falls from 2 to 0."""

BEYOND: Final = 0.15  # |s''| stays below this beyond the turning point; its maximum there is 0.1477


@final
@dataclass(frozen=True, eq=False)
class Enclosure:
    """A set that holds ``phi(z, c)`` for all z in ``[-1, 1]^d``: a union of K boxes under affine maps."""

    centre: FloatArray  # (..., K, m), rad/s
    spread: FloatArray  # (..., K, g, m), rad/s
    remainder: FloatArray  # (..., K, m), zero or more, rad/s

    def largest(self) -> FloatArray:
        """Upper bound of ``‖phi(z, c)‖`` over all z, (...,), rad/s; NaN where the decoder gives NaN."""
        count = self.spread.shape[-2]
        if count > MOST_CORNERS_OF:
            reach = _length(self.centre) + _length(self.spread).sum(axis=-1)
        else:
            signs = np.array(list(product((-1.0, 1.0), repeat=count))).reshape(2**count, count)
            reach = _length(self.centre[..., None, :] + signs @ self.spread).max(axis=-1)
        return (1.0 + ROUNDING) * (reach + _length(self.remainder)).max(axis=-1)

    def furthest(self, direction: FloatArray) -> FloatArray:
        """Upper bound (...,) of ``w·phi(z, c)`` over all z, w (..., m): the support function."""
        w = direction[..., None, :]
        sides = np.abs(np.vecdot(w[..., None, :], self.spread)).sum(axis=-1)
        reach = sides + np.vecdot(np.abs(w), self.remainder)
        middle = np.vecdot(w, self.centre)
        return (middle + reach + ROUNDING * (np.abs(middle) + reach)).max(axis=-1)

    def mapped(self, matrix: FloatArray) -> Self:
        """The enclosure of ``phi @ matrix``, with a matrix (..., 1, m, m') or (m, m')."""
        flat = matrix if matrix.ndim == 2 else matrix[..., 0, :, :]
        return type(self)(self.centre @ flat, self.spread @ matrix, self.remainder @ np.abs(flat))

    def shifted(self, offset: FloatArray) -> Self:
        """The enclosure of ``phi + offset``, (..., m)."""
        return type(self)(self.centre + offset[..., None, :], self.spread, self.remainder)

    def minus(self, other: Self) -> Self:
        """The enclosure of the difference of two decoders that are enclosed in the same cells of z."""
        return type(self)(
            self.centre - other.centre, self.spread - other.spread, self.remainder + other.remainder
        )

    def bent(self, value: FloatArray, slope: FloatArray, curvature: FloatArray | float) -> Self:
        """The enclosure after an activation of every entry.

        ``value`` and ``slope`` (..., K, m) are the activation of the centre and its derivative, and
        ``curvature`` bounds its second derivative within `radius` of the centre.
        """
        rest = np.abs(slope) * self.remainder + 0.5 * curvature * np.square(self.radius)
        return type(self)(value, slope[..., None, :] * self.spread, rest)

    @property
    def radius(self) -> FloatArray:
        """(..., K, m), how far an entry may be from the centre's."""
        return np.abs(self.spread).sum(axis=-2) + self.remainder


def cells(d: int, fineness: int) -> tuple[FloatArray, float]:
    """Centres (K, d) of the cells of ``[-1, 1]^d``, and half their width; a larger ``fineness`` has more."""
    per_axis = fineness * CELLS_PER_AXIS.get(d, 1)
    middles = (2.0 * np.arange(per_axis) + 1.0) / per_axis - 1.0
    return np.array(list(product(middles, repeat=d))), 1.0 / per_axis


def linear_enclosure(columns: FloatArray, offset: FloatArray) -> Enclosure:
    """The enclosure of ``offset (..., m) + Σ z_i columns_i (..., d, m)``, rad/s, exact and in one cell."""
    centre = offset[..., None, :]
    return Enclosure(centre, columns[..., None, :, :], np.zeros(centre.shape))


def celled(columns: FloatArray, offset: FloatArray, fineness: int) -> Enclosure:
    """The enclosure of `linear_enclosure` in the `cells` of z."""
    middles, half = cells(columns.shape[-2], fineness)
    centre = middles @ columns + offset[..., None, :]
    spread = np.broadcast_to(half * columns[..., None, :, :], (*centre.shape[:-1], *columns.shape[-2:]))
    return Enclosure(centre, spread, np.zeros(centre.shape))


def network_enclosure(
    from_latent: FloatArray,
    offset: FloatArray,
    layers: Sequence[tuple[FloatArray, FloatArray]],
    fineness: int,
) -> Enclosure:
    """The enclosure of a network as `numpy_networks.propagate` runs it.

    Cells half as wide leave about a quarter of the remainder. ``from_latent`` (d, h) maps inputs to the first
    layer's pre-activations, halved where an activation follows, to which context and bias add ``offset``
    (..., h). The later layers are halved but for the last.
    """
    if not layers:
        columns = np.broadcast_to(from_latent, (*offset.shape[:-1], *from_latent.shape))
        return linear_enclosure(columns, offset)
    found = celled(from_latent, offset, fineness)
    for weight, bias in layers:
        tanh = np.tanh(found.centre)
        value = found.centre * (1.0 + tanh)
        slope = 1.0 + tanh + found.centre * (1.0 - tanh * tanh)
        found = found.bent(value, slope, curvature(found.centre, found.radius)).mapped(weight).shifted(bias)
    return found


def curvature(centre: FloatArray, radius: FloatArray) -> FloatArray:
    """Upper bound of ``|s''|`` within a radius of a centre, for ``s(h) = h + h tanh h``.

    ``s''`` is even. On [0, `TURNING_POINT`] it is positive and falls, beyond it is negative and above
    -`BEYOND`: so the larger of `BEYOND` and of its value at the point nearest to zero bounds it.
    """
    nearest = np.clip(np.abs(centre) - radius, 0.0, TURNING_POINT)
    tanh = np.tanh(nearest)
    return np.maximum(2.0 * (1.0 - tanh * tanh) * (1.0 - nearest * tanh), BEYOND)


def _length(vectors: FloatArray) -> FloatArray:
    """(..., m) to (...,)."""
    return np.sqrt(np.vecdot(vectors, vectors))
