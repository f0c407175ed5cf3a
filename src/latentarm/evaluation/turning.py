"""Turning: how far the motion turns while the stick turns; 1 follows the stick, more is erratic.

The stick is fully deflected and moved once around in K equal turns: z(θ) = (cos θ, sin θ). Between two
neighbours the arm's motion turns by some angle, and the figure is that angle over the stick's. A linear
isometry gives 1 everywhere. A decoder that knows one direction only turns about by 180° within two of the K
turns, and by nothing between them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions
from latentarm.robots.kinematics.chain import Chain

DIRECTIONS: Final = 36
"""K: turns of 10°. The two in which a decoder of one direction turns about are then more than one in twenty,
so that a 95th percentile shows them."""


@dataclass(frozen=True)
class TurnRatios:
    """Turn of the motion per turn of the stick, NaN where nothing moves."""

    joints: FloatArray  # (S, N, K), of the joints' velocity
    tool: FloatArray  # (S, N, K), of the velocity of the tool's place


def turning(
    decoders: Sequence[DecodesActions],
    context: FloatArray,
    chain: Chain,
    directions: int = DIRECTIONS,
) -> TurnRatios:
    """Lead a full push of a two-axis stick once around, in every context (N, c)."""
    if any(decoder.latent_dim != 2 for decoder in decoders):
        raise ValueError("A stick that is led around has two axes.")
    angle = np.arange(directions) * (2.0 * np.pi / directions)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    z = np.broadcast_to(around, (len(context), *around.shape))
    action = np.stack([decoder.decode(z, context[:, None]) for decoder in decoders])
    velocity = chain.jacobian(context[:, : action.shape[-1]])[:, :3]
    step = 2.0 * np.pi / directions
    return TurnRatios(
        joints=_turned(action) / step, tool=_turned(np.einsum("nij,snkj->snki", velocity, action)) / step
    )


def _turned(motion: FloatArray) -> FloatArray:
    """Angle (..., K), rad, from each motion (..., K, m) to the next, the first after the last."""
    length = np.linalg.norm(motion, axis=-1, keepdims=True)
    unit = np.divide(motion, length, out=np.full_like(motion, np.nan), where=length > 0)
    following = np.roll(unit, -1, axis=-2)
    # Exact near 0 and near 180 degrees, where arccos is not.
    apart, along = np.linalg.norm(following - unit, axis=-1), np.linalg.norm(following + unit, axis=-1)
    return 2.0 * np.arctan2(apart, along)
