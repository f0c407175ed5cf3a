"""The optics of a camera from pictures of a board."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import cv2
import numpy as np

from latentarm.core.errors import UserError
from latentarm.surroundings.tags.board import BoardView
from latentarm.surroundings.tags.lens import Lens

FEWEST_VIEWS: Final = 10
MOST_RMS_PX: Final = 1.0
MOST_FOCAL_SD: Final = 0.005  # as a share of the focal length
LEAST_TILT_DEG: Final = 15.0  # RMS over the pictures, of the board against the plane of the picture
LEAST_COVER: Final = 0.6  # of the width and of the height that corners must have been in


@final
@dataclass(frozen=True, eq=False)
class Intrinsics:
    """A calibrated lens."""

    lens: Lens
    rms_px: float  # of the corners
    focal_sd: float  # SD of the focal length as a share of it


def calibrate_intrinsics(views: Sequence[BoardView], size_px: tuple[int, int]) -> Intrinsics:
    """Calibrate from pictures of ``size_px``, width and height.

    Raises UserError, which says what to do, where the pictures do not determine the lens.
    """
    if len(views) < FEWEST_VIEWS:
        raise UserError(
            f"The board is in {len(views)} pictures, and {FEWEST_VIEWS} are needed: take more, with all of"
            " the board in the light."
        )
    pixels = np.concatenate([view.pixels for view in views])
    cover = np.ptp(pixels, axis=0) / size_px
    if cover.min() < LEAST_COVER:
        raise UserError(
            f"The board was in only {100 * cover.min():.0f} % of the picture's width or height, and"
            f" {100 * LEAST_COVER:.0f} % are needed: hold it near all four edges of the picture too."
        )
    rms_px, matrix, distortion, turns, _, sd, _, _ = cv2.calibrateCameraExtended(
        [view.points.astype(np.float32) for view in views],
        [view.pixels.astype(np.float32) for view in views],
        size_px,
        np.eye(3),
        np.zeros(5),
        flags=cv2.CALIB_FIX_K3,
    )
    # Of boards that face the camera, a longer focal length and a larger distance fit alike.
    out_of_plane = np.array([cv2.Rodrigues(turn)[0][2, 2] for turn in turns])
    tilt_deg = float(np.degrees(np.sqrt((np.arccos(np.abs(out_of_plane)) ** 2).mean())))
    focal_sd = float(np.max(np.ravel(sd)[:2] / np.diag(matrix)[:2]))
    if not rms_px <= MOST_RMS_PX:
        raise UserError(
            f"The corners of the board are {rms_px:.1f} px from where they should be, and {MOST_RMS_PX:g} px"
            " is the most: keep the board flat and still, and state its squares as they were printed."
        )
    if not (focal_sd <= MOST_FOCAL_SD and tilt_deg >= LEAST_TILT_DEG):
        raise UserError(
            f"The board was tilted by {tilt_deg:.0f}°, and the focal length is known to"
            f" {100 * focal_sd:.1f} %: {LEAST_TILT_DEG:.0f}° and {100 * MOST_FOCAL_SD:g} % are needed. Tilt"
            " the board by 30° or more, to all sides, in most pictures."
        )
    return Intrinsics(
        Lens(size_px, np.asarray(matrix, np.float64), np.asarray(distortion, np.float64).ravel()),
        float(rms_px),
        focal_sd,
    )
