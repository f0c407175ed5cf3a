"""Whether there is enough light to see by."""

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
    """Says whether it is too dark, picture by picture; near the limit it does not change its mind.

    Attributes:
        dark: whether it is.
    """

    def __init__(self) -> None:
        self.dark = False

    def see(self, planes: NDArray[np.uint8]) -> None:
        """Look at a picture.

        Args:
            planes: see `latentarm.web.cameras.picture.Picture`.
        """
        self.dark = brightness(planes) < (LIGHT if self.dark else DARK)


def brightness(planes: NDArray[np.uint8]) -> float:
    """Mean brightness of a picture, 0 for black and 1 for white, from one pixel in 64.

    Args:
        planes: see `latentarm.web.cameras.picture.Picture`.
    """
    rows = 2 * planes.shape[0] // 3
    mean = float(planes[:rows:_EVERY, ::_EVERY].mean(dtype=np.float64))
    return min(max((mean - _BLACK) / (_WHITE - _BLACK), 0.0), 1.0)
