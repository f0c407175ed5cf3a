"""The optics of a camera: pinhole and distortion, as OpenCV has them."""

from dataclasses import dataclass
from typing import final

import cv2
import numpy as np

from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True, eq=False)
class Lens:
    """Intrinsic parameters of a camera."""

    size_px: tuple[int, int]  # width and height of the pictures that they hold for
    matrix: FloatArray  # (3, 3), focal lengths and principal point, px
    distortion: FloatArray  # (k,), in OpenCV's order: k1, k2, p1, p2, k3, ...

    @property
    def focal_px(self) -> float:
        """Mean focal length, px."""
        return float(self.matrix[0, 0] + self.matrix[1, 1]) / 2.0

    def normalised(self, pixels: FloatArray) -> FloatArray:
        """Undistorted coordinates (..., 2) of points (..., 2), px, on the plane at depth 1."""
        flat = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        # The iteration of undistortPoints alone stops at 1e-2 px.
        criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 40, 1e-9)
        found = cv2.undistortPointsIter(flat, self.matrix, self.distortion, np.eye(3), np.eye(3), criteria)
        return np.asarray(found, np.float64).reshape(pixels.shape)
