"""SCL without its training: sizes and the decoder ``M(c) z`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure, linear_enclosure
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import NORM_FLOOR, halve_hidden, layers_of, propagate, scale_context


@final
class _Runtime(Runtime):
    """M(c) z of the state-conditioned linear model, the columns of M orthonormal."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = layers_of(trained, seed)
        first = scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        joints = trained.dimensions.action
        self._parts = [slice(axis * joints, (axis + 1) * joints) for axis in range(trained.dimensions.latent)]
        self._gain: FloatArray = trained.latents.scale[seed, 0] * trained.actions.scale

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        columns = self._columns(context)
        scaled = z * self._gain
        action = scaled[..., :1] * columns[0]
        for axis in range(1, len(columns)):
            action = action + scaled[..., axis : axis + 1] * columns[axis]
        return action

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`; linear in z, so exact."""
        columns = np.stack(self._columns(context), axis=-2) * self._gain[:, None]
        return linear_enclosure(columns, np.zeros((*columns.shape[:-2], columns.shape[-1])))

    def _columns(self, context: FloatArray) -> list[FloatArray]:
        """The d columns of M(c), each (..., m)."""
        raw = propagate(context @ self._weight + self._bias, self._rest)
        return _orthonormal([raw[..., part] for part in self._parts])


def _orthonormal(columns: list[FloatArray]) -> list[FloatArray]:
    """Gram-Schmidt over d columns, each (..., m)."""
    done: list[FloatArray] = []
    for raw in columns:
        column = raw
        for other in done:
            column = column - np.vecdot(column, other)[..., None] * other
        done.append(column / np.sqrt(np.vecdot(column, column) + NORM_FLOOR)[..., None])
    return done


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    outputs = dimensions.latent * dimensions.action
    return {"decoder": (dimensions.context, *dimensions.hidden, outputs)}


SCL: Final = ModelKind(
    name="scl",
    label="SCL",
    estimator="latentarm.models.scl.training:SCL",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="projection",
    rests_at_zero=True,
    reverses=True,
    advice="The scl rests and goes back; on recordings of real arms --model homogeneous had a lower error and"
    " reached goals nearer, and takes longer to train.",
)
