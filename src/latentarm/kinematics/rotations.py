"""Rotation vectors: the logarithm and exponential of rotation matrices, batched and fast."""

import numpy as np

from latentarm.types import FloatArray, Pose


def rotation_vector(rotation: FloatArray) -> FloatArray:
    """Logarithm of rotation matrices, accurate at 0 and at pi alike.

    Goes over the unit quaternion with its largest component found first (Shepperd's method), so
    that nothing is divided by something small.

    Args:
        rotation: (..., 3, 3).

    Returns:
        (..., 3), axis times angle, rad, with the angle in [0, pi].
    """
    quaternion = _quaternion(rotation)
    vector = quaternion[..., 1:]
    sine = np.sqrt(np.vecdot(vector, vector))
    angle = 2.0 * np.arctan2(sine, quaternion[..., 0])
    # angle / sine -> 2 as both go to zero.
    factor = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)
    return vector * factor[..., None]


def rotation_from_vector(vector: FloatArray) -> FloatArray:
    """Exponential of rotation vectors (Rodrigues' formula).

    Args:
        vector: (..., 3), axis times angle, rad.

    Returns:
        (..., 3, 3), rotation matrices.
    """
    angle = np.sqrt(np.vecdot(vector, vector))[..., None, None]
    skew = np.zeros((*vector.shape[:-1], 3, 3))
    skew[..., 0, 1], skew[..., 0, 2], skew[..., 1, 2] = -vector[..., 2], vector[..., 1], -vector[..., 0]
    skew -= skew.mT
    # np.sinc keeps sin(x)/x and (1 - cos x)/x² = sinc²(x/2)/2 exact at zero.
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    return np.eye(3) + first * skew + second * (skew @ skew)


def angle_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angle of the turn that takes one rotation to another.

    Args:
        first: (..., 3, 3).
        second: (..., 3, 3).

    Returns:
        (...), rad, in [0, pi].
    """
    vector = rotation_vector(second @ first.mT)
    return np.sqrt(np.vecdot(vector, vector))


def pose_error(x_from: Pose, x_to: Pose) -> FloatArray:
    """The twist that, held for one second, takes one pose to another.

    Args:
        x_from: where the frame is.
        x_to: where it should be.

    Returns:
        (..., 6), m and rad, in the base frame: rows as in ``Chain.jacobian``.
    """
    turn = rotation_vector(x_to.rotation @ x_from.rotation.mT)
    return np.concatenate([x_to.position - x_from.position, turn], axis=-1)


def _quaternion(rotation: FloatArray) -> FloatArray:
    """(..., 4), unit quaternion (w, x, y, z) with w >= 0."""
    r = rotation
    xx, yy, zz = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    # Row i of the outer product 4 q qᵀ is q times its own i-th component.
    outer = np.empty((*r.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1.0 + xx + yy + zz
    outer[..., 1, 1] = 1.0 + xx - yy - zz
    outer[..., 2, 2] = 1.0 - xx + yy - zz
    outer[..., 3, 3] = 1.0 - xx - yy + zz
    outer[..., 0, 1] = outer[..., 1, 0] = r[..., 2, 1] - r[..., 1, 2]
    outer[..., 0, 2] = outer[..., 2, 0] = r[..., 0, 2] - r[..., 2, 0]
    outer[..., 0, 3] = outer[..., 3, 0] = r[..., 1, 0] - r[..., 0, 1]
    outer[..., 1, 2] = outer[..., 2, 1] = r[..., 1, 0] + r[..., 0, 1]
    outer[..., 1, 3] = outer[..., 3, 1] = r[..., 2, 0] + r[..., 0, 2]
    outer[..., 2, 3] = outer[..., 3, 2] = r[..., 2, 1] + r[..., 1, 2]
    largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    quaternion = np.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    quaternion = quaternion / np.sqrt(np.vecdot(quaternion, quaternion))[..., None]
    return np.where(quaternion[..., :1] < 0.0, -quaternion, quaternion)
