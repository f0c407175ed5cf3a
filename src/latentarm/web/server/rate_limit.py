"""Count WebSocket frames of every kind against what a page may send: text, fragments, pings and pongs.

uvicorn answers pings itself and joins fragments, so the application sees neither. They are counted here, in
the bytes as they arrive.
"""

import asyncio
import struct
import time
from collections.abc import Callable
from typing import Any, Final, final

from uvicorn.config import Config
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState

RATE: Final = 100.0  # frames per second that a page may send
BURST: Final = 100.0  # frames that may come at once, such as after a network outage
TOO_MANY: Final = 1008  # close code for too many frames; RFC 6455 calls it a policy violation
_BAD_REQUEST: Final = b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"

_MASK_BYTES: Final = 4
_LENGTH_BYTES: Final = {126: 2, 127: 8}
_REASON: Final = b"too many frames"
_CLOSE: Final = b"\x88" + bytes([0x80 | 2 + len(_REASON)]) + bytes(_MASK_BYTES)
_CLOSE_FOR_TOO_MANY: Final = _CLOSE + struct.pack("!H", TOO_MANY) + _REASON
"""A close frame with a mask of zeros, as the page might have sent it."""


@final
class Allowance:
    """A token bucket with `BURST` tokens that gains `RATE` per second."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._left = BURST
        self._at_s = now_s()

    def spend(self) -> bool:
        """Take one token. Returns False if none is left."""
        now_s = self._now_s()
        self._left = min(self._left + (now_s - self._at_s) * RATE, BURST)
        self._at_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


@final
class FrameMeter:
    """Finds where frames begin in a stream of bytes, and spends a token on each (RFC 6455, section 5.2)."""

    def __init__(self, allowance: Allowance) -> None:
        self._allowance = allowance
        self._head = bytearray()
        self._left = 0

    def pass_on(self, data: bytes) -> tuple[bytes, bool]:
        """Count the frames in ``data``, which may be cut anywhere.

        Returns the bytes before the first frame that is one too many, and whether there was none such. An
        incomplete frame head is held back, so that what is passed on never ends inside one.
        """
        passed = bytearray()
        at = 0
        while at < len(data):
            if self._left:
                taken = min(self._left, len(data) - at)
                passed += data[at : at + taken]
                self._left -= taken
                at += taken
                continue
            self._head.append(data[at])
            at += 1
            length = _frame_length(self._head)
            if length is None:
                continue
            if not self._allowance.spend():
                return bytes(passed), False
            passed += self._head
            self._left = length
            self._head.clear()
        return bytes(passed), True


def _frame_length(head: bytearray) -> int | None:
    if len(head) < 2:
        return None
    short = head[1] & 0x7F
    extended = _LENGTH_BYTES.get(short, 0)
    mask = _MASK_BYTES if head[1] & 0x80 else 0
    if len(head) < 2 + extended + mask:
        return None
    return int.from_bytes(head[2 : 2 + extended], "big") if extended else short


@final
class MeteredSocket(asyncio.Protocol):
    """uvicorn's WebSocket behind a `FrameMeter`.

    If a page sends too many frames, uvicorn and the application see a connection that the page closed with
    `TOO_MANY`; uvicorn answers the page with the same code.
    """

    def __init__(self, config: Config, server_state: ServerState, app_state: dict[str, Any]) -> None:
        self._inner = WebSocketsSansIOProtocol(config, server_state, app_state)
        self._meter = FrameMeter(Allowance())
        self._greeted = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Forward to uvicorn."""
        self._inner.connection_made(transport)

    def data_received(self, data: bytes) -> None:
        """Forward the frames that the allowance admits."""
        if not self._greeted:
            # uvicorn hands over the request for the socket, whole, before any frame.
            self._greeted = True
            self._inner.data_received(data)
            if not self._inner.handshake_initiated:
                # The websockets library has found it faulty, and uvicorn would wait for ever.
                self._inner.transport.write(_BAD_REQUEST)
                self._inner.transport.close()
            return
        passed, good = self._meter.pass_on(data)
        if passed:
            self._inner.data_received(passed)
        if not good:
            self._inner.data_received(_CLOSE_FOR_TOO_MANY)

    def eof_received(self) -> bool | None:
        """Forward to uvicorn."""
        return self._inner.eof_received()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forward to uvicorn."""
        self._inner.connection_lost(exc)

    def pause_writing(self) -> None:
        """Forward to uvicorn."""
        self._inner.pause_writing()

    def resume_writing(self) -> None:
        """Forward to uvicorn."""
        self._inner.resume_writing()
