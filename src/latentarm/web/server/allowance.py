"""How much a page may send: a bucket that empties with every message and fills up again."""

import time
from collections.abc import Callable
from typing import Final, final

RATE: Final = 100.0
"""Frames a second that a page may send."""

BURST: Final = 100.0
"""Frames that may come at once, as after a moment without network."""


@final
class Allowance:
    """A token bucket with `BURST` tokens that gains `RATE` a second.

    Args:
        now_s: the time, s; monotonic.
    """

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._left = BURST
        self._at_s = now_s()

    def spend(self) -> bool:
        """Take one token. Returns False if none is left."""
        now_s = self._now_s()
        self._left = min(self._left + (now_s - self._at_s) * RATE, BURST)
        self._at_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
