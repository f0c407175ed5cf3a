"""Logging of the server and its libraries, safe for a terminal."""

import logging
from typing import Any, Final

from latentarm.core.untrusted.terminal import one_line, visible

_TRACEBACKS: Final = logging.Formatter()

_OTHERS: Final = ("uvicorn", "uvicorn.error")

LOGGING: Final[dict[str, Any]] = {
    "version": 1,
    "disable_existing_loggers": False,
    "filters": {"printable": {"()": lambda: make_printable}},
    "handlers": {
        "terminal": {
            "class": "logging.StreamHandler",
            "formatter": "plain",
            "filters": ["printable"],
        }
    },
    "formatters": {"plain": {"format": "%(levelname)s: %(message)s"}},
    "root": {"handlers": ["terminal"], "level": "WARNING"},
    # These warn of every request for a missing page or that is not HTTP: strangers could flood the terminal.
    "loggers": {name: {"level": "ERROR"} for name in _OTHERS},
}
"""For `logging.config.dictConfig`: warnings and errors, without control characters."""


def make_printable(record: logging.LogRecord) -> bool:
    """Escape control characters in a record's message and traceback: both quote what strangers send.

    Changes the record in place and returns True: it is logged.
    """
    record.msg = one_line(record.getMessage())
    record.args = ()
    if record.exc_info:
        record.exc_text = visible(_TRACEBACKS.formatException(record.exc_info))
    return True
