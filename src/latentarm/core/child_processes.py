"""Child processes that Ctrl-C and a closed terminal do not reach: their parent ends them in good order."""

import multiprocessing
import signal
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
from typing import Final

HANG_UPS: Final = (signal.SIGHUP,) if hasattr(signal, "SIGHUP") else ()
"""A terminal that is closed sends it to all processes that were started there; Windows has none."""


def start_child(target: Callable[..., None], arguments: tuple[object, ...], name: str) -> BaseProcess:
    """Start a function of a module in a new interpreter, which is killed at the latest when this one exits.

    It inherits that the signals are blocked, so they do not reach it while it imports either.
    """
    process = multiprocessing.get_context("spawn").Process(
        target=target, args=arguments, name=name, daemon=True
    )
    with _interrupted_later():
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            process.start()
            return process
        resource_tracker.ensure_running()  # it unblocks SIGINT when it starts
        before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, *HANG_UPS))
        try:
            process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return process


@contextmanager
def _interrupted_later() -> Generator[None]:
    """Put Ctrl-C off to the end of the block: a child that is not told all that it waits for prints an error.

    Another thread may take the signal, blocked or not, and only the main thread is interrupted by it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
    for number in came:
        signal.raise_signal(number)
