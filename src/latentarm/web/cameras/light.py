"""Whether a picture is too dark to see."""

from typing import Final, final

import numpy as np
from numpy.typing import NDArray

DARK: Final = 0.08
LIGHT: Final = 0.11
"""Mean brightness under which it is too dark, and from which it is light again, as shares of white."""

_BLACK, _WHITE = 16.0, 235.0
_EVERY: Final = 8


@final
class Light:
    """Judges the light picture by picture, with hysteresis."""

    def __init__(self) -> None:
        self.dark = False

    def see(self, planes: NDArray[np.uint8]) -> None:
        """Judge a picture, see `Picture.planes`."""
        self.dark = brightness(planes) < (LIGHT if self.dark else DARK)


def brightness(planes: NDArray[np.uint8]) -> float:
    """Mean brightness of a picture, from 0 for black to 1 for white, by one pixel in 64."""
    rows = 2 * planes.shape[0] // 3
    mean = float(planes[:rows:_EVERY, ::_EVERY].mean(dtype=np.float64))
    return min(max((mean - _BLACK) / (_WHITE - _BLACK), 0.0), 1.0)
