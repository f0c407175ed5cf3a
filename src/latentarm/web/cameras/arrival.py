"""When a picture from the network was taken, as far as its stamp and its arrival tell.

A camera stamps its pictures with a clock of its own, whose start nobody knows. The picture that came quickest
says how far that clock is behind ours. One that comes later than it should by that, because the network or
this computer does not keep up, is older by as much.
"""

from typing import Final, final

import numpy as np

DRIFT: Final = 2e-4
"""The camera's clock may run faster or slower than ours by this share."""


@final
class ArrivalClock:
    """A camera's clock, seen from here."""

    def __init__(self) -> None:
        self._behind_s = self._looked_s = np.inf

    def arrived(self, stamp_s: float, now_s: float) -> None:
        """A packet has come.

        Args:
            stamp_s: its stamp, s on the camera's clock.
            now_s: the time here, s; monotonic.
        """
        drifted_s = DRIFT * (now_s - self._looked_s) if np.isfinite(self._looked_s) else 0.0
        self._behind_s, self._looked_s = min(self._behind_s + drifted_s, now_s - stamp_s), now_s

    def taken_s(self, stamp_s: float, now_s: float) -> float:
        """When a picture was taken, s on our clock; at the latest now.

        Args:
            stamp_s: its stamp, s on the camera's clock.
            now_s: the time here, s.
        """
        return min(stamp_s + self._behind_s, now_s)
