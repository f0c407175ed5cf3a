"""The low-turning model without its training: the columns of its curve in NumPy, and sizes."""

from functools import cached_property
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.homogeneous.runtime import DAMPING_M2, ORDERS, CurveDecoder, curve_sizes
from latentarm.models.kind import ModelKind
from latentarm.models.numpy_networks import NORM_FLOOR

BEND_SIZE: Final = 0.15
"""Factor of the network's bends, so that they start with about as much of the curve's length as M_1."""


@final
class _Runtime(CurveDecoder):
    """Columns that are orthogonal as joint velocities."""

    def _columns(self, context: FloatArray, jacobian: FloatArray) -> FloatArray:
        columns = self._raw_columns(context)
        columns[..., self._latents :] *= self._bend_sizes
        for axis in range(self._latents):
            column = columns[..., axis]
            column /= np.sqrt(np.vecdot(column, column) + NORM_FLOOR)[..., None]
            after = columns[..., axis + 1 :]
            after -= column[..., None] * np.vecmat(column, after)[..., None, :]
        return columns

    @cached_property
    def _bend_sizes(self) -> FloatArray:
        return bend_sizes(self._latents)


def bend_sizes(latent_dim: int) -> FloatArray:
    """Factors (orders d,) of the network's bends: 1 / n for order n, which adds n times as much length."""
    return BEND_SIZE / np.repeat(np.array(ORDERS, dtype=np.float64), latent_dim)


LOW_TURNING: Final = ModelKind(
    name="low_turning",
    label="low turning",
    estimator="latentarm.models.low_turning.training:LowTurning",
    runtime=_Runtime,
    decoder=curve_sizes,
    encoder="nearest",
    rests_at_zero=True,
    reverses=True,
    damping_m2=DAMPING_M2,
    way_back_m=0.06,
    advice="The low_turning suits a driver who is still learning what each push does; where it leaves out"
    " motions that matter, try --model homogeneous, which reproduces more and turns faster.",
)
