"""An enabled arm to which nobody gives an input is disabled after a while."""

import math
from collections.abc import Callable
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Notice

USUAL_MINUTES: Final = 2.0
SAID_S: Final = 15.0  # so long before, pages say that the arm will be disabled
_LIMITS_MINUTES: Final = (0.5, 60.0)


def idle_s_of(minutes: float) -> float:
    """The limit in seconds. Raises UserError if it is out of range."""
    low, high = _LIMITS_MINUTES
    if not low <= minutes <= high:
        raise UserError(f"--idle-minutes is {minutes:g}: it must be from {low:g} to {high:g}.")
    return 60.0 * minutes


@final
class IdleLimit:
    """Counts the time without an input; after ``limit_s`` it calls ``stop``."""

    def __init__(self, limit_s: float, stop: Callable[[Notice], None]) -> None:
        self._limit_s = limit_s
        self._stop = stop
        self._used_s = -math.inf
        self.left_s: int | None = None  # whole seconds until it is disabled, in the last `SAID_S`

    def look(self, now_s: float, *, used: bool) -> None:
        """Call once a tick; ``used``: whether the arm is disabled, or somebody gives an input."""
        if used:
            self._used_s = now_s
        left_s = self._limit_s - (now_s - self._used_s)
        self.left_s = math.ceil(left_s) if not used and 0.0 < left_s <= SAID_S else None
        if left_s <= 0.0:
            self._used_s = now_s
            self._stop(Notice(code="idle", parameters={"seconds": round(self._limit_s)}))
