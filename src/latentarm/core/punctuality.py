"""Scheduling, garbage collection and pauses of processes that must answer within milliseconds."""

import gc
import math
import os
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Final, final

_PRIORITY: Final = 10  # lowest real-time priority
_HELD_UP_S: Final = 0.1  # a shorter pause explains no silence of an arm, s
_REMEMBERED_S: Final = 2.0


def ask_for_priority() -> bool:
    """Run before ordinary processes, if the system allows it; returns whether it does."""
    with suppress(OSError, AttributeError):  # not allowed, or not supported by the system
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))
        return True
    return False


@contextmanager
def short_collections() -> Generator[None]:
    """Keep the garbage collector away from everything loaded so far while the block runs.

    A full collection looks at every object of every library and takes 0.1 s and more, in which nothing else
    in the process runs: inputs come late, and the arm stops.
    """
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


@final
class OwnPauses:
    """Notes how late the waits of a loop end: this computer alone delays those, and no cable.

    For the thread of the loop; others may read.
    """

    def __init__(self) -> None:
        self._longest = (0.0, -math.inf)  # s, and when on the monotonic clock, s

    def wait(self, signal: threading.Event | threading.Condition, for_s: float) -> None:
        """Wait for a signal, or so long."""
        began_s = time.monotonic()
        signal.wait(for_s)
        self.note(time.monotonic() - began_s - for_s)

    def note(self, late_s: float) -> None:
        """Note that a wait has ended so much later than it should have, s."""
        now_s, (longest_s, at_s) = time.monotonic(), self._longest
        if late_s > longest_s or now_s - at_s > _REMEMBERED_S:
            self._longest = late_s, now_s

    def or_else(self, advice: str) -> str:
        """Advice for an arm that was not heard of; another where this program was held up itself."""
        longest_s, at_s = self._longest
        if longest_s < _HELD_UP_S or time.monotonic() - at_s > _REMEMBERED_S:
            return advice
        return (
            f"this computer held up this program itself for {1000 * longest_s:.0f} ms, so end other programs"
            " and see `latentarm doctor` before you look at the cable"
        )
