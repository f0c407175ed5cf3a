"""Logging of all processes: warnings to the terminal, more to files, and nothing that a terminal obeys."""

import logging
import re
import time
from collections.abc import Generator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from logging.handlers import QueueHandler, QueueListener
from pathlib import Path
from queue import SimpleQueue
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.terminal import one_line, visible

LONG_BYTES: Final = 1 << 20  # a log that is longer when a program begins gives way to a new one

_TRACEBACKS: Final = logging.Formatter()
_SECRET: Final = re.compile(r"\b(key|pin|token|cookie)=[^\s&;]+", re.IGNORECASE)

_OURS: Final = ("latentarm", "latentarm_research")
_OTHERS: Final = ("uvicorn", "uvicorn.error")
"""These warn of every request for a missing page or that is not HTTP: strangers could flood the terminal."""


@final
@dataclass(frozen=True)
class LogSettings:
    """Where to log; other processes of a command are started with the same."""

    verbose: bool = False  # the terminal also shows what is usual, and files have details
    files: tuple[Path, ...] = ()


_USUAL: Final = LogSettings()
_SETTINGS: Final[ContextVar[LogSettings]] = ContextVar("log settings", default=_USUAL)


def log_settings() -> LogSettings:
    """The settings at present."""
    return _SETTINGS.get()


@contextmanager
def logging_as(settings: LogSettings) -> Generator[None]:
    """Log to the terminal and to files while the block runs.

    Raises UserError if a file cannot be written.
    """
    terminal = logging.StreamHandler()
    terminal.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))
    terminal.setLevel(logging.INFO if settings.verbose else logging.WARNING)
    for name in _OURS:
        logging.getLogger(name).setLevel(logging.DEBUG if settings.verbose else logging.INFO)
    for name in _OTHERS:
        logging.getLogger(name).setLevel(logging.ERROR)
    with ExitStack() as stack:
        stack.enter_context(_handled_by(terminal))
        for path in settings.files:
            stack.enter_context(_written_to(path))
        token = _SETTINGS.set(settings)
        stack.callback(_SETTINGS.reset, token)
        yield


@contextmanager
def logging_also_to(path: Path) -> Generator[None]:
    """Log to this file too while the block runs. Raises UserError if it cannot be written."""
    before = log_settings()
    with _written_to(path):
        token = _SETTINGS.set(replace(before, files=(*before.files, path)))
        try:
            yield
        finally:
            _SETTINGS.reset(token)


@contextmanager
def _handled_by(handler: logging.Handler) -> Generator[None]:
    handler.addFilter(make_printable)
    logging.getLogger().addHandler(handler)
    try:
        yield
    finally:
        logging.getLogger().removeHandler(handler)


@contextmanager
def _written_to(path: Path) -> Generator[None]:
    """A thread writes, so that nobody waits for the disk."""
    file = _file(path)
    lines: SimpleQueue[logging.LogRecord] = SimpleQueue()
    writing = QueueListener(lines, file)
    writing.start()
    try:
        with _handled_by(QueueHandler(lines)):
            yield
    finally:
        writing.stop()
        file.close()


def _file(path: Path) -> logging.Handler:
    try:
        if path.is_file() and path.stat().st_size > LONG_BYTES:
            path.replace(path.with_name(f"{path.name}.1"))
        handler = logging.FileHandler(path, encoding="utf-8", errors="backslashreplace")
    except OSError as error:
        raise UserError(f"The log {path} cannot be written: {error.strerror or error}.") from error
    format_ = logging.Formatter("%(asctime)sZ %(levelname)s %(name)s: %(message)s")
    format_.converter = time.gmtime
    handler.setFormatter(format_)
    return handler


def make_printable(record: logging.LogRecord) -> bool:
    """Escape control characters in a record's message and traceback, and leave out secrets.

    Both quote what strangers send. Changes the record in place and returns True: it is logged.
    """
    record.msg = _SECRET.sub(r"\1=...", one_line(record.getMessage()))
    record.args = ()
    if record.exc_info:
        record.exc_text = _SECRET.sub(r"\1=...", visible(_TRACEBACKS.formatException(record.exc_info)))
    return True
