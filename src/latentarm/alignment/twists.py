"""Motions of the tools as vectors in which a turn counts like a distance, and how joints cause them."""

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.poses import ROTATION_WEIGHT_M
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import pose_error


def motion_twists(chain: Chain, motions: Motions) -> FloatArray:
    """Mean velocities of all k tools in N motions, (N, 6 k), m/s.

    Of each tool the linear velocity, and the angular one times `ROTATION_WEIGHT_M`, both in the base frame.
    The squared length is the mean over tools.
    """
    parts = [
        pose_error(chain.forward(motions.start, tool), chain.forward(motions.end, tool))
        for tool in range(len(chain.tools))
    ]
    return np.concatenate(parts, axis=-1) * _weights(chain) / motions.duration_s


def tool_jacobian(chain: Chain, transforms: FloatArray) -> FloatArray:
    """The Jacobian (..., 6 k, n) of `motion_twists`, m/s per rad/s, for link transforms (..., n, 4, 4)."""
    parts = [
        chain.jacobian_at(transforms, chain.tool_pose(transforms, tool), tool)
        for tool in range(len(chain.tools))
    ]
    return np.concatenate(parts, axis=-2) * _weights(chain)[:, None]


def _weights(chain: Chain) -> FloatArray:
    each = np.repeat([1.0, ROTATION_WEIGHT_M], 3)
    return np.tile(each, len(chain.tools)) / np.sqrt(len(chain.tools))
