"""`latentarm`, which is also ``python -m latentarm``: Ctrl-C ends it with one line, however early or late."""

import os
import signal
import sys
from types import FrameType


def main() -> int:
    """Run the command line; its exit code, 130 where Ctrl-C broke it off."""
    interrupted = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        interrupted = True
        raise KeyboardInterrupt

    # Where a script started it in the background, Ctrl-C is not for it.
    heeded = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heeded:
        signal.signal(signal.SIGINT, _end_at_once)
    from latentarm.cli import main as run

    try:
        if heeded:
            signal.signal(signal.SIGINT, interrupt)
        return run()
    except (KeyboardInterrupt, ImportError):
        # An extension in C++ that is broken off while it is imported raises an ImportError instead.
        if not interrupted:
            raise
        return _say_so()
    finally:
        if heeded:
            signal.signal(signal.SIGINT, _end_at_once)


def _end_at_once(number: int, frame: FrameType | None) -> None:
    """End where nothing is open: imports, and the end of the interpreter, print or lose an exception."""
    os._exit(_say_so())


def _say_so() -> int:
    os.write(2, b"latentarm: interrupted.\n")
    return 130


if __name__ == "__main__":
    sys.exit(main())
