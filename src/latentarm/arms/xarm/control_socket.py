"""The connection for requests."""

import contextlib
import socket
import struct
import time
from typing import Final, final

from latentarm.arms.xarm.sdk import Port

_HEADER: Final = 6
_LARGEST: Final = 1024
_SMALLEST: Final = 8  # shorter frames lack a code, and the library cannot read them


@final
class ControlSocket(Port):
    """A TCP connection that never delivers a command late.

    The manufacturer's own port leaves unsent commands in the kernel's buffer, and TCP delivers them once a
    cable is plugged in again. Here `abort` drops undelivered commands, and so does the kernel after
    ``undelivered_s`` (where it knows ``TCP_USER_TIMEOUT``) if the process has ended.
    """

    def __init__(self, host: str, port: int, timeout_s: float, undelivered_s: float) -> None:
        self._socket = socket.create_connection((host, port), timeout_s)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if hasattr(socket, "TCP_USER_TIMEOUT"):
            self._socket.setsockopt(
                socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, max(1, round(1000 * undelivered_s))
            )
        self._socket.settimeout(0.0)
        self._received = bytearray()
        self.connected = True

    def flush(self) -> int:
        with contextlib.suppress(BlockingIOError):
            while self.connected and self._receive():
                pass
        while self._frame() is not None:
            pass
        return 0

    def write(self, data: bytes) -> int:
        """Send a frame; 0, or -1 on failure."""
        if not self.connected:
            return -1
        try:
            sent = self._socket.send(data)
        except OSError:
            sent = -1
        if sent < len(data):  # its buffer is full: the controller has long stopped reading
            self.abort()
            return -1
        return 0

    def read(self, timeout: float | None = None) -> bytes | int:
        """The next frame, or -1 where none has come within the time, s."""
        until_s = time.monotonic() + (timeout or 0.0)
        while (frame := self._frame()) is None:
            if not self.connected:
                return -1
            try:
                self._receive()
            except BlockingIOError:
                left_s = until_s - time.monotonic()
                if left_s <= 0.0:
                    return -1
                self._wait(left_s)
        return frame

    def abort(self) -> None:
        """End the connection and drop undelivered data."""
        with contextlib.suppress(OSError):
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.close()

    def close(self) -> None:
        self.connected = False
        with contextlib.suppress(OSError):
            self._socket.close()

    def _wait(self, span_s: float) -> None:
        """Wait until there is something to read, or for this long, s."""
        try:
            self._socket.settimeout(span_s)
            self._socket.recv(1, socket.MSG_PEEK)
        except TimeoutError:
            pass
        except OSError:
            self.abort()
        finally:
            with contextlib.suppress(OSError):
                self._socket.settimeout(0.0)

    def _receive(self) -> bool:
        """Take incoming data; False where the connection has ended."""
        try:
            data = self._socket.recv(4096)
        except BlockingIOError:
            raise
        except OSError:
            data = b""
        if not data:
            self.abort()
            return False
        self._received += data
        return True

    def _frame(self) -> bytes | None:
        if len(self._received) < _HEADER:
            return None
        size = int.from_bytes(self._received[4:6], "big") + _HEADER
        if not _SMALLEST <= size <= _LARGEST:
            self._received.clear()
            self.abort()
            return None
        if len(self._received) < size:
            return None
        frame = bytes(self._received[:size])
        del self._received[:size]
        return frame
