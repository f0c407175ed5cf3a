"""Scheduling and garbage collection for processes that must answer within milliseconds."""

import gc
import os
import signal
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Final

HANG_UPS: Final = (signal.SIGHUP,) if hasattr(signal, "SIGHUP") else ()
"""A terminal that is closed sends it to all processes that were started there; Windows has none."""

_PRIORITY: Final = 10  # lowest real-time priority


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
