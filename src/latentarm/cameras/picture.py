"""One picture of a camera, and when it was taken."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

MOST_WIDE: Final = 640
MOST_HIGH: Final = 480
"""Larger pictures are scaled down, so that two cameras leave a small computer time for the arm."""

MOST_PER_S: Final = 30  # pictures per second that are sent at most


@final
@dataclass(frozen=True)
class Picture:
    """One picture."""

    # (3 H / 2, W) bytes, YUV 4:2:0 as one array: H rows of Y, then U and V. H and W are even.
    planes: NDArray[np.uint8]
    captured_s: float  # when it was taken, s; on the monotonic clock of this computer


def fitted(width: int, height: int) -> tuple[int, int]:
    """Width and height to send, px: within the limits, of the same shape, even, at least 2 each."""
    share = min(1.0, MOST_WIDE / width, MOST_HIGH / height)
    return tuple(max(2, 2 * round(share * side / 2)) for side in (width, height))  # pyright: ignore[reportReturnType]
