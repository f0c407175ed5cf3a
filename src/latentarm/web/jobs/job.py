"""Slow work in a child process, so that neither the page's server nor the arm waits for it.

The child has one thread and a low priority, and ends with its parent. They exchange JSON of a strict schema
over pipes; reading never makes the parent wait.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Final, Generic, TypeVar, final

from pydantic import BaseModel, TypeAdapter, ValidationError
from threadpoolctl import threadpool_limits

from latentarm.core.child_processes import start_child
from latentarm.core.errors import UserError, naming_extras
from latentarm.web.protocol.notice import Message, Notice, notice_of

MESSAGE_LIMIT: Final = 1 << 20

_NICENESS: Final = 10
_GRACE_S: Final = 2.0  # how long a child may take to tidy up, s

Said = TypeVar("Said", bound=Message)
Told = TypeVar("Told", bound=BaseModel)


class _Failed(Message):
    failed: Notice


@final
@dataclass(eq=False)
class Wire:
    """The child's end of the pipes: from and to the parent."""

    _hearing: Connection
    _saying: Connection

    def say(self, message: Message) -> None:
        """Send a message to the parent. Raises SystemExit if the parent is gone."""
        try:
            self._saying.send_bytes(message.model_dump_json().encode())
        except OSError:
            sys.exit(1)

    def hear(self, kind: TypeAdapter[Told]) -> Told:
        """Wait for the parent's next valid message. Raises SystemExit if the parent is gone."""
        while True:
            try:
                return kind.validate_json(self._hearing.recv_bytes(MESSAGE_LIMIT))
            except ValidationError:
                continue
            except (EOFError, OSError):
                sys.exit(1)


@final
class Job(Generic[Said]):
    """A child process at work. Everything but `end` returns at once.

    A `UserError` of the work ends it and is kept as `failure`; any other error is printed to standard error,
    and `failure` says that the work broke off. ``work`` is a module's function, called in the child with its
    `Wire` and ``arguments``, which multiprocessing pickles. Its module must not import torch: the number of
    threads is set before. ``kind`` is that of the child's messages.
    """

    def __init__(
        self, work: Callable[..., None], arguments: tuple[object, ...], kind: type[Said], name: str
    ) -> None:
        child_hears, self._saying = multiprocessing.Pipe(duplex=False)
        self._hearing, child_says = multiprocessing.Pipe(duplex=False)
        os.set_blocking(self._saying.fileno(), False)
        self._kind = kind
        self._heard: deque[Said] = deque()
        self.failure: Notice | None = None  # why it failed; None while it is at work and if it succeeded
        self._ended = False
        self._process = start_child(_run, (work, arguments, child_hears, child_says), name)
        child_hears.close()
        child_says.close()
        # In a thread, because a half-written message would make its reader wait.
        self._listener = threading.Thread(target=self._listen, name=name, daemon=True)
        self._listener.start()

    @property
    def alive(self) -> bool:
        """Whether it is at work, or a message is still on its way."""
        return self._listener.is_alive()

    def heard(self) -> list[Said]:
        """The child's messages since the last call, oldest first."""
        return [self._heard.popleft() for _ in range(len(self._heard))]

    def say(self, message: Message) -> bool:
        """Send the child a short message; returns False if it has ended or has stopped reading."""
        try:
            self._saying.send_bytes(message.model_dump_json().encode())
        except OSError:
            return False
        return True

    def end(self) -> None:
        """End it, by force after two seconds. That is not a failure."""
        self._ended = True
        if self._listener.is_alive():
            self._process.terminate()
            self._listener.join(_GRACE_S)
        if self._listener.is_alive():
            self._process.kill()
            self._listener.join()
        self._saying.close()

    def _listen(self) -> None:
        with self._hearing, suppress(EOFError, OSError):
            while True:
                self._take(self._hearing.recv_bytes(MESSAGE_LIMIT))
        self._process.join()
        if self._process.exitcode != 0 and self.failure is None and not self._ended:
            self.failure = Notice(code="work_broke_off")

    def _take(self, message: bytes) -> None:
        if (failed := _Failed.parse(message)) is not None:
            self.failure = failed.failed
            return
        if (said := self._kind.parse(message)) is not None:
            self._heard.append(said)


def _run(
    work: Callable[..., None], arguments: tuple[object, ...], hearing: Connection, saying: Connection
) -> None:
    signal.signal(signal.SIGTERM, _tidy_up)
    threading.Thread(target=_die_with_parent, daemon=True).start()
    with suppress(OSError, AttributeError):  # not supported by the system
        os.nice(_NICENESS)
    os.environ["OMP_NUM_THREADS"] = "1"  # read by torch when it is loaded
    wire = Wire(hearing, saying)
    with threadpool_limits(1):
        try:
            with naming_extras():
                work(wire, *arguments)
        except UserError as error:
            wire.say(_Failed(failed=notice_of(error)))


def _tidy_up(number: int, frame: FrameType | None) -> None:
    """Leave through every ``finally``, so that no temporary files stay."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sys.exit(1)


def _die_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os.kill(os.getpid(), signal.SIGTERM)
        threading.Event().wait(_GRACE_S)
    os._exit(1)
