"""A ChArUco board: a chessboard with markers, of which any part may be in the picture."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import cv2
import numpy as np
from numpy.typing import NDArray

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.surroundings.tags.frames import transform_of
from latentarm.surroundings.tags.lens import Lens

FEWEST_CORNERS: Final = 8  # of the board in a picture that counts
_MARKER: Final = 0.75  # side of a marker as a share of a square's


@final
@dataclass(frozen=True, eq=False)
class BoardView:
    """Corners of a board found in one picture."""

    points: FloatArray  # (N, 3), inner corners in the board's frame, m
    pixels: FloatArray  # (N, 2), the same in the picture, px


@final
@dataclass(frozen=True)
class Board:
    """A board with markers of ``aruco_4x4_50``."""

    columns: int
    rows: int
    square_m: float  # side of a square

    def __post_init__(self) -> None:
        if not (self.rows >= 3 and self.columns >= 3 and self.rows * self.columns <= 100):
            raise UserError("A board has 3 or more squares along each side, and 100 at most.")
        if not 0.005 <= self.square_m <= 0.5:
            raise UserError("The squares of a board have sides of 5 to 500 mm.")

    @cached_property
    def made(self) -> cv2.aruco.CharucoBoard:
        """OpenCV's."""
        markers = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        return cv2.aruco.CharucoBoard(
            (self.columns, self.rows), self.square_m, _MARKER * self.square_m, markers
        )

    def find(self, grey: NDArray[np.uint8]) -> BoardView | None:
        """The board in a picture; None where too little of it is visible."""
        found = cv2.aruco.CharucoDetector(self.made).detectBoard(grey)
        pixels, numbers = found[:2]
        if numbers is None or len(numbers) < FEWEST_CORNERS:  # pyright: ignore[reportUnnecessaryComparison]
            return None
        points = np.asarray(self.made.getChessboardCorners(), np.float64)[
            np.asarray(numbers, np.int64).ravel()
        ]
        # Corners in one row do not say how the board is turned.
        if min(np.ptp(points[:, :2], axis=0)) <= 0.0:
            return None
        return BoardView(points, np.asarray(pixels, np.float64).reshape(-1, 2))


def board_pose(view: BoardView, lens: Lens) -> FloatArray | None:
    """The board's pose (4, 4) in the camera's frame, m; None where none fits."""
    seen = lens.normalised(view.pixels)
    found, turn, position = cv2.solvePnP(view.points, seen, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE)
    if not found:
        return None
    turn, position = cv2.solvePnPRefineLM(view.points, seen, np.eye(3), None, turn, position)
    return transform_of(turn, position)
