"""The test pattern `testsrc`: a machine-readable clock, so that a picture shows its delay."""

import threading
import time
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from latentarm.cameras.picture import MOST_HIGH, MOST_PER_S, MOST_WIDE, Picture

BITS: Final = 32
"""Bars of the code: milliseconds of Unix time, modulo 2 to this power, as a Gray code, highest bit first."""

ROWS: Final = 64
"""The code is in these rows from the top, one bar next to the other over the whole width: white is one."""

_BLACK, _WHITE, _GREY = 16, 235, 110
_NEUTRAL: Final = 128
_TURN_S: Final = 2.0
_SQUARE: Final = 60


def clock_pictures(closing: threading.Event) -> Iterator[Picture]:
    """Pictures of the clock until closed; each is stamped with the moment that it shows."""
    number, began_s = 0, time.monotonic()
    while not closing.wait(max(0.0, began_s + number / MOST_PER_S - time.monotonic())):
        now_s, unix_s = time.monotonic(), time.time()
        yield Picture(clock_picture(unix_s), now_s)
        number = int((time.monotonic() - began_s) * MOST_PER_S) + 1


def clock_picture(unix_s: float) -> NDArray[np.uint8]:
    """The pattern at Unix time, s, see `Picture.planes`: the code above, a square that goes around below."""
    planes = np.full((3 * MOST_HIGH // 2, MOST_WIDE), _NEUTRAL, np.uint8)
    planes[:MOST_HIGH] = _GREY
    code = int(unix_s * 1000.0) % (1 << BITS)
    gray = code ^ (code >> 1)
    bits = np.array([(gray >> bit) & 1 for bit in reversed(range(BITS))], np.uint8)
    planes[:ROWS] = np.repeat(np.where(bits, _WHITE, _BLACK), MOST_WIDE // BITS)
    turn = 2.0 * np.pi * (unix_s % _TURN_S) / _TURN_S
    row = int(ROWS + (MOST_HIGH - ROWS - _SQUARE) * (1.0 - np.cos(turn)) / 2.0)
    column = int((MOST_WIDE - _SQUARE) * (1.0 + np.sin(turn)) / 2.0)
    planes[row : row + _SQUARE, column : column + _SQUARE] = _WHITE
    return planes
