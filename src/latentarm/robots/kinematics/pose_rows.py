"""Poses of things as rows of numbers, in the form of decoders and in that of datasets."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from latentarm.core.context import OBJECT
from latentarm.core.errors import UserError
from latentarm.core.types import NO_THINGS, FloatArray, Pose
from latentarm.robots.kinematics.rotations import quaternion

STORED: Final = 7  # position and quaternion (w, x, y, z)


def pose_rows(pose: Pose) -> FloatArray:
    """Poses for decoders, (..., 9): position, m, then ``rotation[..., :2]`` row by row."""
    columns = pose.rotation[..., :2].reshape(*pose.position.shape[:-1], 6)
    return np.concatenate([pose.position, columns], axis=-1)


def object_rows(poses: Mapping[str, Pose], names: Sequence[str]) -> FloatArray:
    """Poses of named things for decoders, (K, 9), in the order of the names, from base-frame poses."""
    for name in names:
        if name not in poses:
            there = ", ".join(poses) or "nothing"
            raise UserError(
                f"The model looks at {name!r}, which is not here; there is: {there}. Name a task with it"
                " (--task), or train a model that sees the joints alone (--context joints)."
            )
    return np.array([pose_rows(poses[name]) for name in names]).reshape(len(names), OBJECT)


def moved_along(rows: FloatArray, before: Pose, after: Pose) -> FloatArray:
    """Rows (..., K, 9) of things that moved with a tool from one pose to another; leading axes broadcast."""
    turn = (after.rotation @ before.rotation.mT)[..., None, :, :]
    away = rows[..., :3] - before.position[..., None, :]
    position = after.position[..., None, :] + (turn @ away[..., None])[..., 0]
    columns = turn @ rows[..., 3:].reshape(*rows.shape[:-1], 3, 2)
    return np.concatenate([position, columns.reshape(*position.shape[:-1], 6)], axis=-1)


def stored_rows(pose: Pose) -> FloatArray:
    """Poses for datasets, (..., 7): position, m, then the quaternion (w, x, y, z), w >= 0."""
    return np.concatenate([pose.position, quaternion(pose.rotation)], axis=-1)


def thing_rows(poses: Mapping[str, Pose], names: Sequence[str]) -> FloatArray:
    """Poses of named things for datasets, (K, 7), in the order of the names, from base-frame poses."""
    if not names:
        return NO_THINGS
    found = [poses[name] for name in names]
    return stored_rows(
        Pose(np.array([pose.position for pose in found]), np.array([pose.rotation for pose in found]))
    )


def seen_rows(stored: FloatArray) -> FloatArray:
    """Turn poses of datasets, (..., 7), with quaternions of any length, into decoders', (..., 9)."""
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
