"""The minimal interfaces that the measures need from a model and a robot.

Anything with these methods can be measured: a trained model, a loaded decoder, or a formula whose measures
are known in closed form.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from latentarm.core.types import FloatArray, Pose


class DecodesActions(Protocol):
    """One decoder ``a = phi(z, c)``, its latent action in input units ([-1, 1] per axis)."""

    @property
    def latent_dim(self) -> int:
        """Number of latent axes d."""
        ...

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Decode z (..., d) in context (..., c) to joint velocities (..., m), rad/s; the two broadcast."""
        ...


class EncodesActions(Protocol):
    """A fitted model of S seeds: an encoder for all seeds at once, and a decoder for each."""

    def encode(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """Encode context (N, c) and action (N, m), rad/s, to z (S, N, d) in input units."""
        ...

    def decoder(self, seed: int = 0) -> DecodesActions:
        """The decoder of one seed."""
        ...


class PlacesTool(Protocol):
    """Forward kinematics ``x = Psi(s)``."""

    def forward(self, q: FloatArray, tool: int = 0) -> Pose:
        """Pose of a tool at joint positions q (..., n), rad."""
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
