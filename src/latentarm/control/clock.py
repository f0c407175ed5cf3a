"""Time for the loop: real, or simulated."""

import sys
import time
from abc import ABC, abstractmethod
from typing import final

from typing_extensions import override


class Clock(ABC):
    """A monotonic clock that can wait."""

    @abstractmethod
    def now_s(self) -> float:
        """Time since some fixed moment, s; never goes back."""

    @abstractmethod
    def wait_until(self, time_s: float) -> None:
        """Return at ``time_s``, or at once if that has passed."""


@final
class MonotonicClock(Clock):
    """The machine's monotonic clock, shared by all its processes.

    Where the system has such a clock (Linux), it keeps counting while the computer sleeps, so that a loop
    that wakes up sees that its last command has expired.
    """

    @override
    def now_s(self) -> float:
        return _monotonic_s()

    @override
    def wait_until(self, time_s: float) -> None:
        left = time_s - _monotonic_s()
        if left > 0.0:
            time.sleep(left)


def _monotonic_s() -> float:
    if sys.platform == "linux":
        return time.clock_gettime(time.CLOCK_BOOTTIME)
    return time.monotonic()


@final
class SimulatedClock(Clock):
    """Time that passes only while something waits: a one-minute drive takes as long as it computes."""

    def __init__(self) -> None:
        self._now_s = 0.0

    @override
    def now_s(self) -> float:
        return self._now_s

    @override
    def wait_until(self, time_s: float) -> None:
        self._now_s = max(self._now_s, time_s)
