"""Pictures of tags and boards, drawn as a camera would see them: by the homography of their plane."""

from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
from numpy.typing import NDArray

from latentarm.core.types import FloatArray
from latentarm.surroundings.tags.detecting import FAMILIES
from latentarm.surroundings.tags.frames import frame
from latentarm.surroundings.tags.lens import Lens

LENS = Lens((640, 480), np.array([[580.0, 0.0, 319.5], [0.0, 580.0, 239.5], [0.0, 0.0, 1.0]]), np.zeros(5))
_FINER = 4  # each pixel is the mean of so many squared


def projected(points: FloatArray) -> FloatArray:
    """Pixels (N, 2) of points (N, 3) in the frame of a camera with `LENS`, m."""
    pixels, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), LENS.matrix, LENS.distortion)
    return np.asarray(pixels, np.float64)[:, 0]


def looking(eye: FloatArray, at: FloatArray) -> FloatArray:
    """The pose (4, 4) of a camera at a point that looks at another, m."""
    ahead = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return frame(np.stack([right, np.cross(ahead, right), ahead], axis=1), eye)


def drawn(planes: list[tuple[NDArray[np.uint8], FloatArray]]) -> NDArray[np.uint8]:
    """A picture by a camera with `LENS`.

    Each plane is an image and its corners (4, 3) in the camera's frame, m, from the top left on clockwise.
    """
    width, height = LENS.size_px
    canvas = np.full((height * _FINER, width * _FINER), 90, np.uint8)
    for image, corners in planes:
        pixels = (projected(corners) + 0.5) * _FINER - 0.5
        high, wide = image.shape
        ends = np.array([(-0.5, -0.5), (wide - 0.5, -0.5), (wide - 0.5, high - 0.5), (-0.5, high - 0.5)])
        warp = cv2.getPerspectiveTransform(ends.astype(np.float32), pixels.astype(np.float32))
        cv2.warpPerspective(
            image, warp, (canvas.shape[1], canvas.shape[0]), canvas, cv2.INTER_LINEAR, cv2.BORDER_TRANSPARENT
        )
    small = cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA)
    return cv2.GaussianBlur(small, (0, 0), 0.6)


def tag_image(number: int) -> NDArray[np.uint8]:
    """A tag of ``apriltag_36h11`` with a white margin of one cell: 10 by 10 cells."""
    made = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(FAMILIES["apriltag_36h11"]), number, 160
    )
    return cv2.copyMakeBorder(made, 20, 20, 20, 20, cv2.BORDER_CONSTANT, value=255)


def write_video(path: Path, picture: NDArray[np.uint8]) -> None:
    """A second of a picture that does not move."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=Fraction(20), options={"crf": "10"})
        stream.width, stream.height, stream.pix_fmt = *LENS.size_px, "yuv420p"
        shown = av.VideoFrame.from_ndarray(picture, format="gray")
        for _ in range(20):
            container.mux(stream.encode(shown))
        container.mux(stream.encode(None))
