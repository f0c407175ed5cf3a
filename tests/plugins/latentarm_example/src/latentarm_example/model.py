"""A model whose directions are the same everywhere: what it is, and its decoder in NumPy."""

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.kind import Dimensions, ModelKind, Runtime, TrainedModel


class StraightRuntime(Runtime):
    """``W z + b``."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        scale, latents = trained.actions.scale, trained.latents
        weight = trained.tensors["decoder.0.weight"][seed]
        bias = trained.tensors["decoder.0.bias"][seed, 0]
        self._weight = latents.scale[seed, 0, :, None] * weight * scale
        self._bias = (latents.centre[seed, 0] @ weight + bias) * scale

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        action = z @ self._weight + self._bias
        shape = np.broadcast_shapes(action.shape[:-1], context.shape[:-1])
        return np.broadcast_to(action, (*shape, action.shape[-1]))


def _sizes(dimensions: Dimensions) -> dict[str, tuple[int, ...]]:
    return {"decoder": (dimensions.latent, dimensions.action)}


STRAIGHT = ModelKind(
    name="straight",
    description="The same straight directions wherever the arm is, learned by gradient.",
    label="straight",
    estimator="latentarm_example.training:Straight",
    runtime=StraightRuntime,
    decoder=_sizes,
    encoder="deterministic",
    sees_context=False,
)
