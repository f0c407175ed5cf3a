"""What a process needs that must answer within milliseconds, whatever else goes on in it and next to it."""

import gc
import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Final

_PRIORITY: Final = 10
"""Lowest real-time priority."""


def ask_for_priority() -> None:
    """Run before ordinary processes, if the system allows it: a busy computer makes us late."""
    with suppress(OSError, AttributeError):  # not allowed, or not supported by the system
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))


@contextmanager
def short_collections() -> Generator[None]:
    """Keep the garbage collector away from what is loaded by now, as long as the block lasts.

    A full collection looks at every object of every library, which takes 0.1 s and more, and nothing else in
    the process runs meanwhile: inputs come late, and the arm stops. What is loaded is never garbage.
    """
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
