"""The conditional flow without its training: the decoder ``Q(c) (z, f(z, c) - f(0, c))`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.core.style import Look
from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure, celled, network_enclosure
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import (
    NORM_FLOOR,
    halve_hidden,
    layers_of,
    propagate,
    scale_context,
    scale_output,
)


@final
class _Runtime(Runtime):
    """The flow from the steered dimensions z, the others at zero, to actions."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        d, self._joints = trained.dimensions.latent, trained.dimensions.action
        self._mirrors = [slice(axis * self._joints, (axis + 1) * self._joints) for axis in range(d)]
        self._gain: FloatArray = trained.latents.scale[seed, 0] * trained.actions.scale
        turn = layers_of(trained, seed)
        (self._turn, self._turn_bias), *self._turns = halve_hidden(
            [scale_context(turn[0], trained), *turn[1:]]
        )
        # Actions come out in rad/s; the output's bias cancels in f(z, c) - f(0, c).
        shift = scale_output(layers_of(trained, seed, "shift"), trained.actions.scale)
        weight, bias = shift[0]
        from_context, bias = scale_context((weight[d:], bias), trained)
        from_latent = weight[:d] * trained.latents.scale[seed, 0][:, None]
        shift[0] = np.concatenate([from_latent, from_context]), bias
        (weight, self._shift_bias), *self._shifts = halve_hidden(shift)
        self._from_latent, self._from_context = weight[:d].copy(), weight[d:].copy()

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """See `Runtime`."""
        here = context @ self._from_context + self._shift_bias
        shift = propagate(z @ self._from_latent + here, self._shifts) - propagate(here, self._shifts)
        d = len(self._gain)
        action = np.empty((*shift.shape[:-1], self._joints))
        action[..., :d] = z * self._gain
        action[..., d:] = shift
        return self._turned(action, context)

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`: the steered dimensions are exact, the others a network's, and Q(c) is linear."""
        here = context @ self._from_context + self._shift_bias
        moved = network_enclosure(self._from_latent, here, self._shifts, fineness)
        moved = moved.shifted(-propagate(here, self._shifts))
        scales = np.broadcast_to(np.diag(self._gain), (*here.shape[:-1], len(self._gain), len(self._gain)))
        steered = celled(scales, np.zeros(scales.shape[:-1]), fineness)
        joined = Enclosure(
            np.concatenate([steered.centre, moved.centre], axis=-1),
            np.concatenate([steered.spread, moved.spread], axis=-1),
            np.concatenate([steered.remainder, moved.remainder], axis=-1),
        )
        axes = np.broadcast_to(np.eye(self._joints), (*here.shape[:-1], self._joints, self._joints)).copy()
        return joined.mapped(self._turned(axes, context[..., None, :])[..., None, :, :])

    def _turned(self, action: FloatArray, context: FloatArray) -> FloatArray:
        """Q(c) of vectors (..., m), one reflection for each axis of z; changes them in place."""
        normals = propagate(context @ self._turn + self._turn_bias, self._turns)
        for part in self._mirrors:
            normal = normals[..., part]
            share = 2 * np.vecdot(normal, action) / (np.vecdot(normal, normal) + NORM_FLOOR)
            action -= share[..., None] * normal
        return action


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    d, m = dimensions.latent, dimensions.action
    return {
        "decoder": (dimensions.context, *dimensions.hidden, d * m),
        "shift": (d + dimensions.context, *dimensions.hidden, m - d),
        "prior": (1, d),
    }


FLOW: Final = ModelKind(
    name="flow",
    look=Look("flow", "#AA4499", "H", (0.0, (2.0, 1.0, 1.0, 1.0))),
    estimator="latentarm.models.flow.training:Flow",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="projection",
    rests_at_zero=True,
    advice="The flow rests but need not go back when the stick is pressed back; for both by construction try"
    " --model odd_cae or --model homogeneous.",
)
