"""Tags in a picture, their corners to a tenth of a pixel."""

from collections.abc import Mapping
from typing import Final, final

import cv2
import numpy as np
from numpy.typing import NDArray

from latentarm.core.types import FloatArray

FAMILIES: Final[Mapping[str, int]] = {
    "apriltag_16h5": cv2.aruco.DICT_APRILTAG_16H5,
    "apriltag_25h9": cv2.aruco.DICT_APRILTAG_25H9,
    "apriltag_36h11": cv2.aruco.DICT_APRILTAG_36H11,
    **{
        f"aruco_{bits}x{bits}_{count}": getattr(cv2.aruco, f"DICT_{bits}X{bits}_{count}")
        for bits in (4, 5, 6, 7)
        for count in (50, 100, 250, 1000)
    },
}
"""Kinds of tags by the name that a tags file gives them."""

_ALONG: Final = np.linspace(0.12, 0.88, 17)  # where a side is looked at, as shares of it: not at its corners
_ACROSS: Final = np.linspace(-1.0, 1.0, 17)  # and how far across it, as shares of the reach
_REACH: Final = 0.1  # as a share of the tag's shortest side: within its black border and its white margin
_REACH_PX: Final = (1.5, 5.0)
_ROUNDS: Final = 2


@final
class Detector:
    """Finds the tags of one family."""

    def __init__(self, family: str) -> None:
        how = cv2.aruco.DetectorParameters()
        how.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_CONTOUR
        self._detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(FAMILIES[family]), how)

    def find(self, grey: NDArray[np.uint8]) -> dict[int, FloatArray]:
        """Corners (4, 2), px, of each tag by its number; a number that is there twice is left out.

        The corners are in the order of `latentarm.surroundings.tags.solving.corners_on_tag`. The centre of
        the first pixel is (0, 0).
        """
        quads, numbers, _ = self._detector.detectMarkers(grey)
        if not quads:
            return {}
        corners = np.asarray(quads, np.float64).reshape(-1, 4, 2)
        for _ in range(_ROUNDS):
            corners = _on_edges(grey, corners)
        found = [int(number) for number in np.ravel(numbers)]
        return {number: four for number, four in zip(found, corners, strict=True) if found.count(number) == 1}


def _on_edges(grey: NDArray[np.uint8], corners: FloatArray) -> FloatArray:
    """Corners (N, 4, 2), px, as crossings of lines through the edges between black border and white margin.

    The corners that OpenCV gives err by 0.5 px, and its slow method by half a pixel in common.
    """
    ends = np.roll(corners, -1, axis=1)
    along = ends - corners
    length = np.linalg.norm(along, axis=-1, keepdims=True)
    along = along / length
    outward = np.stack([along[..., 1], -along[..., 0]], axis=-1)  # corners go clockwise, y down
    reach = np.clip(_REACH * length.min(axis=1), *_REACH_PX)[:, :, None]  # (N, 1, 1)
    middle = corners[:, :, None] + (_ALONG[:, None] * length[:, :, None]) * along[:, :, None]
    places = middle[:, :, :, None] + (_ACROSS * reach)[:, :, None, :, None] * outward[:, :, None, None]
    flat = places.reshape(len(corners) * 4 * len(_ALONG), len(_ACROSS), 2).astype(np.float32)
    light = cv2.remap(grey, flat[..., 0], flat[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    steps = np.maximum(np.diff(light.astype(np.float64)), 0.0).reshape(*middle.shape[:-1], -1)
    weight = steps.sum(axis=-1) + 1e-9
    off = (steps @ ((_ACROSS[1:] + _ACROSS[:-1]) / 2.0)) / weight * reach
    return _crossings(middle + off[..., None] * outward[:, :, None], weight)


def _crossings(points: FloatArray, weight: FloatArray) -> FloatArray:
    """Crossings (N, 4, 2) of lines through points (N, 4, K, 2), weighted (N, 4, K), with the lines before."""
    share = (weight / weight.sum(axis=-1, keepdims=True))[..., None]
    centre = (share * points).sum(axis=-2)
    away = points - centre[..., None, :]
    _, directions = np.linalg.eigh(away.mT @ (share * away))
    normal = directions[..., :, 0]  # of least spread
    normals = np.stack([np.roll(normal, 1, axis=1), normal], axis=-2)
    offsets = np.roll((normal * centre).sum(axis=-1), 1, axis=1), (normal * centre).sum(axis=-1)
    return np.linalg.solve(normals, np.stack(offsets, axis=-1)[..., None])[..., 0]
