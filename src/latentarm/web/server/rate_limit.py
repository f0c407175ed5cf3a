"""Count WebSocket frames of every kind against what a page may send: text, fragments, pings and pongs.

uvicorn answers pings itself and joins fragments, so the application sees neither. They are counted where the
websockets library takes each frame.
"""

import time
from collections.abc import Callable
from typing import Any, Final, final

from uvicorn.config import Config
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState
from websockets.exceptions import ProtocolError
from websockets.frames import Frame

RATE: Final = 100.0  # frames per second that a page may send
BURST: Final = 100.0  # frames that may come at once, such as after a network outage
TOO_MANY: Final = 1008  # close code for too many frames; RFC 6455 calls it a policy violation
_REASON: Final = "too many frames"
_BAD_REQUEST: Final = b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


@final
class Allowance:
    """A token bucket: ``burst`` tokens, and ``rate`` more per second up to as many."""

    def __init__(
        self, now_s: Callable[[], float] = time.monotonic, rate: float = RATE, burst: float = BURST
    ) -> None:
        self._now_s = now_s
        self._rate, self._burst = rate, burst
        self._left = burst
        self._at_s = now_s()

    def spend(self) -> bool:
        """Take one token. Returns False if none is left."""
        now_s = self._now_s()
        self._left = min(self._left + (now_s - self._at_s) * self._rate, self._burst)
        self._at_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


@final
class MeteredSocket(WebSocketsSansIOProtocol):
    """uvicorn's WebSocket, which a page that sends too many frames finds closed with `TOO_MANY`."""

    def __init__(self, config: Config, server_state: ServerState, app_state: dict[str, Any]) -> None:
        super().__init__(config, server_state, app_state)
        self._allowance = Allowance()
        self._take = self.conn.recv_frame
        self.conn.recv_frame = self._take_if_allowed

    def data_received(self, data: bytes) -> None:
        """Take bytes; uvicorn hands over the request for the socket, whole, before any frame."""
        super().data_received(data)
        if not self.handshake_initiated:
            # The websockets library has found the request faulty, and uvicorn would wait for ever.
            self.transport.write(_BAD_REQUEST)
            self.transport.close()

    def _take_if_allowed(self, frame: Frame) -> None:
        if not self._allowance.spend():
            self.conn.fail(TOO_MANY, _REASON)
            raise ProtocolError(_REASON)
        self._take(frame)
