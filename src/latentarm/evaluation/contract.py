"""The part of a decoder that the measures need: a trained one has it, and so has a formula."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from latentarm.core.types import FloatArray


class DecodesActions(Protocol):
    """One decoder ``a = phi(z, c)``, its latent action in input units ([-1, 1] per axis)."""

    @property
    def latent_dim(self) -> int:
        """Number of latent axes d."""
        ...

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Decode z (..., d) in context (..., c) to joint velocities (..., m), rad/s; the two broadcast."""
        ...


def zero_latent(decoder: DecodesActions, context: FloatArray) -> FloatArray:
    """The input at rest, z = 0, for each context (..., c): shape (..., d)."""
    return np.zeros((*context.shape[:-1], decoder.latent_dim))


def next_context(context: FloatArray, action: FloatArray, step_s: float) -> FloatArray:
    """The transition ``T(s, a) = s + a dt`` of section 8.1 on contexts ``(s, ...)``.

    Contexts (..., c) begin with the state, rad; actions are (..., m), rad/s. The rest of the context (a
    belief) stays unchanged: these measures are about the decoder, not about the inference around it.
    """
    dof = action.shape[-1]
    state = context[..., :dof] + step_s * action
    return np.concatenate(
        [state, np.broadcast_to(context[..., dof:], (*state.shape[:-1], context.shape[-1] - dof))], -1
    )


def decode_all(decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray) -> FloatArray:
    """Decode z (S, N, d), one leading entry per seed, in shared contexts (N, c): (S, N, m), rad/s."""
    return np.stack([decoder.decode(latent, context) for decoder, latent in zip(decoders, z, strict=True)])
