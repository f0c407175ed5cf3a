"""A helper process that runs one module and exchanges JSON messages with this one.

A helper goes on when this process stalls or is killed: it gets an `EOFError`. A message arrives whole or not
at all, and neither end waits for the other to read. Linux only (``SOCK_SEQPACKET``).
"""

import json
import os
import select
import socket
import subprocess
import sys
from collections.abc import Mapping
from typing import Any, Final, Self, cast, final

from latentarm.core.errors import UserError

_LARGEST: Final = 1 << 16  # bytes of a message


@final
class MessagePort:
    """One end of a connected pair of sockets that keep messages apart."""

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        end.setblocking(False)

    @classmethod
    def of_helper(cls) -> Self:
        """The helper's end; its file descriptor is the helper's last argument."""
        return cls(socket.socket(fileno=int(sys.argv[-1])))

    def send(self, message: Mapping[str, object]) -> bool:
        """Send a message without waiting; False if the other end is gone, or does not read."""
        try:
            self._end.send(json.dumps(message).encode())
        except OSError:
            return False
        return True

    def receive(self, wait_s: float = 0.0) -> dict[str, Any] | None:
        """The next message within ``wait_s``, or None. Raises EOFError if the other end is gone."""
        if not select.select([self._end], [], [], wait_s)[0]:
            return None
        try:
            text = self._end.recv(_LARGEST)
        except OSError as error:
            raise EOFError from error
        if not text:
            raise EOFError
        return cast("dict[str, Any]", json.loads(text))

    def close(self) -> None:
        """Let the other end see that this one is gone."""
        self._end.close()


@final
class HelperProcess:
    """A running helper, which takes its end with `MessagePort.of_helper`; ours is ``port``.

    It has its own session, so that Ctrl-C in a terminal ends this process only, which then ends the helper in
    good order.
    """

    def __init__(self, module: str) -> None:
        if not hasattr(socket, "SOCK_SEQPACKET"):
            raise UserError("This needs Linux: no other system keeps messages between processes apart.")
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", module, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                start_new_session=True,
                env=os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
            )
        self.port = MessagePort(ours)

    @property
    def pid(self) -> int:
        """The helper's process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    def end(self, within_s: float) -> None:
        """Close this end, wait for the helper to bring things to rest, and kill it after ``within_s``."""
        self.port.close()
        try:
            self._process.wait(within_s)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
