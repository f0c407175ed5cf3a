"""When a picture from the network was taken, estimated from its stamp and its arrival.

A camera stamps its pictures with its own clock, whose start is unknown. The quickest picture shows the offset
of that clock from ours. A picture with a larger delay, because of the network or this computer, is older by
the difference.
"""

from typing import Final, final

import numpy as np

DRIFT: Final = 2e-4
"""The camera's clock may run faster or slower than ours by this share."""


@final
class ArrivalClock:
    """The offset of a camera's clock from the local monotonic one."""

    def __init__(self) -> None:
        self._behind_s = self._looked_s = np.inf

    def arrived(self, stamp_s: float, now_s: float) -> None:
        """Note a packet: its stamp on the camera's clock, s, and the local time, s."""
        drifted_s = DRIFT * (now_s - self._looked_s) if np.isfinite(self._looked_s) else 0.0
        self._behind_s, self._looked_s = min(self._behind_s + drifted_s, now_s - stamp_s), now_s

    def taken_s(self, stamp_s: float, now_s: float) -> float:
        """When the picture with this stamp was taken, s on the local clock; at the latest now."""
        return min(stamp_s + self._behind_s, now_s)
