"""Poses of things as rows of numbers: as decoders see them, and as datasets store them."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from latentarm.core.context import OBJECT
from latentarm.core.errors import UserError
from latentarm.core.types import NO_THINGS, FloatArray, Pose
from latentarm.robots.kinematics.rotations import quaternion

STORED: Final = 7
"""Position and quaternion (w, x, y, z)."""


def pose_rows(pose: Pose) -> FloatArray:
    """Poses as decoders see them, (..., 9): position, m, then the first two columns of the rotation.

    The columns lie row by row, as in ``rotation[..., :2]``.
    """
    columns = pose.rotation[..., :2].reshape(*pose.position.shape[:-1], 6)
    return np.concatenate([pose.position, columns], axis=-1)


def object_rows(poses: Mapping[str, Pose], names: Sequence[str]) -> FloatArray:
    """Poses of named things as decoders see them, (K, 9), in the order of the names.

    Args:
        poses: in the base frame, by name, such as `SceneState.poses`.
        names: K names, such as those that a model was trained with.

    Raises:
        UserError: there is no thing of a name.
    """
    for name in names:
        if name not in poses:
            there = ", ".join(poses) or "nothing"
            raise UserError(f"The model looks at {name!r}, which is not here; there is: {there}.")
    return np.array([pose_rows(poses[name]) for name in names]).reshape(len(names), OBJECT)


def moved_along(rows: FloatArray, before: Pose, after: Pose) -> FloatArray:
    """Poses of things that a tool takes along, as decoders see them.

    Args:
        rows: (..., K, 9), where they were.
        before: pose of the tool then, (...,).
        after: pose of the tool now, (...,); leading axes broadcast.

    Returns:
        (..., K, 9).
    """
    turn = (after.rotation @ before.rotation.mT)[..., None, :, :]
    away = rows[..., :3] - before.position[..., None, :]
    position = after.position[..., None, :] + (turn @ away[..., None])[..., 0]
    columns = turn @ rows[..., 3:].reshape(*rows.shape[:-1], 3, 2)
    return np.concatenate([position, columns.reshape(*position.shape[:-1], 6)], axis=-1)


def stored_rows(pose: Pose) -> FloatArray:
    """Poses as datasets store them, (..., 7): position, m, then the quaternion (w, x, y, z), w >= 0."""
    return np.concatenate([pose.position, quaternion(pose.rotation)], axis=-1)


def thing_rows(poses: Mapping[str, Pose], names: Sequence[str]) -> FloatArray:
    """Poses of named things as datasets store them, (K, 7), in the order of the names.

    Args:
        poses: in the base frame, by name, such as `SceneState.poses`.
        names: K names that are all among them.
    """
    if not names:
        return NO_THINGS
    found = [poses[name] for name in names]
    return stored_rows(
        Pose(np.array([pose.position for pose in found]), np.array([pose.rotation for pose in found]))
    )


def seen_rows(stored: FloatArray) -> FloatArray:
    """From poses as datasets store them, (..., 7), to poses as decoders see them, (..., 9).

    Quaternions need not have the length 1 exactly, since datasets are in single precision.

    Raises:
        UserError: a quaternion is zero, or nearly so, and stands for no rotation.
    """
    w, x, y, z = np.moveaxis(stored[..., 3:], -1, 0)
    length = w * w + x * x + y * y + z * z
    if not (length > 1e-6).all():
        raise UserError("The quaternion of a thing's pose is zero: a pose that is not turned has 1, 0, 0, 0.")
    scale = 2.0 / length
    columns = [
        1.0 - scale * (y * y + z * z),
        scale * (x * y - w * z),
        scale * (x * y + w * z),
        1.0 - scale * (x * x + z * z),
        scale * (x * z - w * y),
        scale * (y * z + w * x),
    ]
    return np.concatenate([stored[..., :3], np.stack(columns, axis=-1)], axis=-1)
