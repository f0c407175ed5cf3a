"""Rigid transforms as homogeneous matrices (4, 4)."""

import cv2
import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray


def frame(rotation: FloatArray, position: FloatArray) -> FloatArray:
    """The transforms (..., 4, 4) of rotations (..., 3, 3) and positions (..., 3), m."""
    made = np.zeros((*rotation.shape[:-2], 4, 4))
    made[..., :3, :3], made[..., :3, 3], made[..., 3, 3] = rotation, position, 1.0
    return made


def inverse(transform: FloatArray) -> FloatArray:
    """The inverses of transforms (..., 4, 4)."""
    turn = transform[..., :3, :3].mT
    return frame(turn, -(turn @ transform[..., :3, 3:])[..., 0])


def moved(transform: FloatArray, points: FloatArray) -> FloatArray:
    """Points (..., N, 3) in the frame that transforms (..., 4, 4) lead to, m."""
    return points @ transform[..., :3, :3].mT + transform[..., None, :3, 3]


def shifted(transform: FloatArray, twist: FloatArray) -> FloatArray:
    """A transform turned by ``twist[3:]``, rad, about its own origin and moved by ``twist[:3]``, m."""
    turn = transform_of(twist[3:], np.zeros(3))[:3, :3]  # a tenth of the time of scipy's
    return frame(turn @ transform[:3, :3], transform[:3, 3] + twist[:3])


def mean_frame(transforms: FloatArray) -> FloatArray:
    """The mean of transforms (N, 4, 4) that are near each other."""
    turn = Rotation.from_matrix(transforms[:, :3, :3]).mean().as_matrix()
    return frame(turn, transforms[:, :3, 3].mean(axis=0))


def transform_of(turn: ArrayLike, position: ArrayLike) -> FloatArray:
    """The transform (4, 4) of a rotation vector or matrix and a position, m, as OpenCV gives them."""
    given = np.asarray(turn, np.float64)
    rotation = given if given.shape == (3, 3) else cv2.Rodrigues(given)[0]
    return frame(np.asarray(rotation, np.float64), np.asarray(position, np.float64).ravel())
