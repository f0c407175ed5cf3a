"""Logarithms and quaternions of rotation matrices, batched and fast."""

import numpy as np

from latentarm.core.types import FloatArray, Pose

_DIAGONAL = np.arange(4)


def _outer_product_map() -> FloatArray:
    """(9, 16), the linear map from a rotation matrix R to 4 q qᵀ - I, both flattened by rows."""
    signs = {
        (0, 0): ((0, 0, 1), (1, 1, 1), (2, 2, 1)),
        (1, 1): ((0, 0, 1), (1, 1, -1), (2, 2, -1)),
        (2, 2): ((0, 0, -1), (1, 1, 1), (2, 2, -1)),
        (3, 3): ((0, 0, -1), (1, 1, -1), (2, 2, 1)),
        (0, 1): ((2, 1, 1), (1, 2, -1)),
        (0, 2): ((0, 2, 1), (2, 0, -1)),
        (0, 3): ((1, 0, 1), (0, 1, -1)),
        (1, 2): ((1, 0, 1), (0, 1, 1)),
        (1, 3): ((2, 0, 1), (0, 2, 1)),
        (2, 3): ((2, 1, 1), (1, 2, 1)),
    }
    table = np.zeros((3, 3, 4, 4))
    for (i, j), terms in signs.items():
        for row, column, sign in terms:
            table[row, column, i, j] = table[row, column, j, i] = sign
    return table.reshape(9, 16)


_OUTER = _outer_product_map()
_ONE = np.eye(4).ravel()


def rotation_vector(rotation: FloatArray) -> FloatArray:
    """Axis times angle in [0, pi], rad, (..., 3), accurate at 0 and at pi (Shepperd's method)."""
    turn = quaternion(rotation)
    vector = turn[..., 1:]
    sine = np.sqrt(np.vecdot(vector, vector))
    angle = 2.0 * np.arctan2(sine, turn[..., 0])
    # angle / sine -> 2 as both go to zero.
    factor = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)
    return vector * factor[..., None]


def angle_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angle (...), in [0, pi], between rotation matrices."""
    vector = rotation_vector(second @ first.mT)
    return np.sqrt(np.vecdot(vector, vector))


def pose_error(x_from: Pose, x_to: Pose) -> FloatArray:
    """The base-frame twist (..., 6), m and rad, that takes one pose to another in one second."""
    turn = rotation_vector(x_to.rotation @ x_from.rotation.mT)
    return np.concatenate([x_to.position - x_from.position, turn], axis=-1)


def quaternion(rotation: FloatArray) -> FloatArray:
    """Unit quaternions (..., 4), (w, x, y, z) with w >= 0, of rotation matrices (..., 3, 3)."""
    # Row i of the outer product 4 q qᵀ is q times its own i-th component: take the largest.
    outer = (rotation.reshape(-1, 9) @ _OUTER + _ONE).reshape(-1, 4, 4)
    largest = outer[:, _DIAGONAL, _DIAGONAL].argmax(axis=-1)
    row = outer[np.arange(len(outer)), largest]
    row *= np.copysign(1.0 / np.sqrt(np.vecdot(row, row)), row[:, 0])[:, None]
    return row.reshape(*rotation.shape[:-2], 4)
