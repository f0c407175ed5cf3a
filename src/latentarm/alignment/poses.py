"""Poses as vectors, so that the distance between poses is the distance between points."""

import math
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain

ROTATION_WEIGHT_M: Final = 0.2
"""A turn of a tool by 1 rad counts like the motion of a point of the hand this far from the tool point, m."""

POSE_SIZE: Final = 12  # entries for each tool: its position, and its weighted rotation matrix row by row


def pose_weights(tools: int) -> tuple[float, float]:
    """Weights of positions and of entries of rotation matrices."""
    return 1 / math.sqrt(tools), ROTATION_WEIGHT_M / math.sqrt(2 * tools)


def pose_vectors(chain: Chain, state: FloatArray) -> FloatArray:
    """``Psi(s)`` of states (..., n), rad, as vectors (..., 12 k), m: positions and rotations of all k tools.

    The squared distance between two such vectors is the mean over tools of ``‖Δp‖^2 + w^2 ‖ΔR‖_F^2 / 2``. The
    latter is ``2 (1 - cos θ)`` for a turn by θ, so about ``θ^2``, and has no seam at half a turn.
    """
    return pose_vectors_at(chain, chain.link_transforms(state))


def pose_vectors_at(chain: Chain, transforms: FloatArray) -> FloatArray:
    """`pose_vectors` when the links' transforms (..., n, 4, 4) are already known."""
    position_weight, rotation_weight = pose_weights(len(chain.tools))
    parts: list[FloatArray] = []
    for tool in range(len(chain.tools)):
        pose = chain.tool_pose(transforms, tool)
        parts.append(position_weight * pose.position)
        parts.append(rotation_weight * pose.rotation.reshape(*transforms.shape[:-3], 9))
    return np.concatenate(parts, axis=-1)
