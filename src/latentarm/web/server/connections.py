"""Accept every new connection, and let none keep others waiting.

uvicorn has no deadline for a request's headers, and its limit on connections counts idle ones too. So
connections are accepted here and handed to uvicorn's HTTP protocol. If there are too many, the one that has
waited longest without a whole request is dropped.
"""

import asyncio
import errno
import logging
import socket
import ssl
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, cast, final

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

try:
    import resource
except ImportError:  # Windows has no such limit
    resource = None

HEAD_LIMIT: Final = 1 << 14
"""The longest request line with headers, bytes."""

_SLICE: Final = 1 << 12
_OUT_OF_RESOURCES: Final = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)
_REST_S: Final = 0.05
_SAY_EVERY_S: Final = 60.0

_ENOUGH_DESCRIPTORS: Final = 1024

_LOG: Final = logging.getLogger(__name__)

_Phase = Literal["head", "body", "answer", "socket", "closing"]


@final
@dataclass(frozen=True)
class ConnectionLimits:
    """How many connections there may be, and how long a peer may take, s."""

    most: int = 384  # far above what `Gate` admits, so that only idle ones are dropped
    head_s: float = 5.0  # for the TLS handshake, and again for a request's headers or until the next request
    body_s: float = 5.0
    stalled_s: float = 10.0  # how long a peer may read nothing that it is sent
    closing_s: float = 2.0  # for reading the rest after the server has closed the connection
    look_s: float = 0.25  # how often this is checked


def limits_here() -> ConnectionLimits:
    """The limits, lower if this process may open few files: each connection takes one descriptor."""
    if resource is None:
        return ConnectionLimits()
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < _ENOUGH_DESCRIPTORS:
        soft = _ENOUGH_DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _ENOUGH_DESCRIPTORS)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    most = ConnectionLimits.most if soft == resource.RLIM_INFINITY else min(ConnectionLimits.most, soft // 2)
    return ConnectionLimits(most=most)


@final
@dataclass(eq=False)
class Connections:
    """Accepts connections, and ends those that take too long.

    ``_serve`` makes a uvicorn protocol for a new connection; ``_tls`` is None for plain HTTP.
    """

    _listening: socket.socket
    _serve: "Callable[[], SlicedProtocol]"
    _tls: ssl.SSLContext | None
    _limits: ConnectionLimits

    def __post_init__(self) -> None:
        # Longest waiting first.
        self._open: dict[_Connection, None] = {}
        self._said_s = -_SAY_EVERY_S

    async def accept(self) -> None:
        """Accept connections until cancelled. Raises OSError if the listening socket has failed."""
        self._listening.setblocking(False)
        loop = asyncio.get_running_loop()
        looking = asyncio.create_task(self._look())
        try:
            while True:
                try:
                    accepted, _ = await loop.sock_accept(self._listening)
                except ConnectionAbortedError:
                    continue
                except OSError as error:
                    if error.errno not in _OUT_OF_RESOURCES:
                        raise
                    self._say(error)
                    self._make_room(len(self._open) - 1)
                    await asyncio.sleep(_REST_S)
                    continue
                self._make_room(self._limits.most - 1)
                self._open[_Connection(accepted, self._serve, self._tls, self._limits)] = None
                # The others get their turn, however many want to come in.
                await asyncio.sleep(0)
        finally:
            looking.cancel()
            for connection in self._open:
                connection.give_up_opening()

    def _make_room(self, most: int) -> None:
        """Drop idle connections, the oldest first, until ``most`` are left."""
        for connection in list(self._open) if len(self._open) > most else ():
            if len(self._open) <= most:
                return
            if connection.gone or connection.phase == "head":
                connection.drop()
                del self._open[connection]

    async def _look(self) -> None:
        """Drop closed and slow connections, until cancelled."""
        while True:
            now_s = time.monotonic()
            for connection in list(self._open):
                if connection.gone:
                    del self._open[connection]
                elif connection.has_gone_on(now_s):
                    self._open[connection] = self._open.pop(connection)
                elif connection.late(now_s):
                    connection.drop()
            await asyncio.sleep(self._limits.look_s)

    def _say(self, error: OSError) -> None:
        now_s = time.monotonic()
        if now_s - self._said_s > _SAY_EVERY_S:
            self._said_s = now_s
            _LOG.warning(
                "There are too many connections for this computer (%s): idle ones are dropped.",
                error.strerror,
            )


@final
class _Connection:
    def __init__(
        self,
        accepted: socket.socket,
        serve: "Callable[[], SlicedProtocol]",
        tls: ssl.SSLContext | None,
        limits: ConnectionLimits,
    ) -> None:
        self._socket = accepted
        self._limits = limits
        self._transport: asyncio.Transport | None = None
        self._since_s = time.monotonic()
        self._unsent = 0
        self._before: tuple[_Phase, object] = ("head", None)
        self._opening = asyncio.create_task(self._open(serve, tls))

    @property
    def gone(self) -> bool:
        """Whether it is closed and its descriptor free."""
        return self._socket.fileno() < 0

    @property
    def phase(self) -> _Phase:
        """A request's headers (or before them), its body, the answer, a WebSocket, or closing."""
        if self._transport is None:
            return "head"
        if self._transport.is_closing():
            return "closing"
        protocol = self._transport.get_protocol()
        if not isinstance(protocol, SlicedProtocol):
            return "socket"
        state = protocol.conn.their_state
        if state is h11.IDLE:
            return "head"
        return "body" if state is h11.SEND_BODY else "answer"

    def has_gone_on(self, now_s: float) -> bool:
        """Whether something has happened since the last call; ``now_s`` is monotonic, s."""
        phase = self.phase
        unsent = 0 if self._transport is None else self._transport.get_write_buffer_size()
        taken = unsent < self._unsent or (phase in ("answer", "socket") and unsent == 0)
        protocol = None if self._transport is None else self._transport.get_protocol()
        now = phase, protocol.cycle if isinstance(protocol, SlicedProtocol) else None
        went_on = taken or now != self._before
        self._unsent, self._before = unsent, now
        if went_on:
            self._since_s = now_s
        return went_on

    def late(self, now_s: float) -> bool:
        """Whether nothing has happened for longer than the phase allows; ``now_s`` is monotonic, s."""
        limits = self._limits
        allowed_s = {
            "head": limits.head_s,
            "body": limits.body_s,
            "answer": limits.stalled_s,
            "socket": limits.stalled_s,
            "closing": limits.closing_s,
        }
        return now_s - self._since_s > allowed_s[self.phase]

    def drop(self) -> None:
        self.give_up_opening()
        if self._transport is not None:
            self._transport.abort()

    def give_up_opening(self) -> None:
        """Abort a connection that uvicorn has not got yet."""
        self._opening.cancel()

    async def _open(self, serve: "Callable[[], SlicedProtocol]", tls: ssl.SSLContext | None) -> None:
        loop = asyncio.get_running_loop()
        try:
            self._transport, _ = await loop.connect_accepted_socket(
                serve,
                self._socket,
                ssl=tls,
                ssl_handshake_timeout=None if tls is None else self._limits.head_s,
            )
        except OSError:  # no handshake (TimeoutError and SSLError are of this kind), or already gone
            self._socket.close()
        except asyncio.CancelledError:
            self._socket.close()
            raise


@final
class SlicedProtocol(H11Protocol):
    """uvicorn's HTTP protocol, fed in small pieces: h11 checks its limit only between two pieces."""

    def data_received(self, data: bytes) -> None:
        """Take bytes, of a WebSocket too from where the request for it ends."""
        for at in range(0, len(data), _SLICE):
            if self.transport.is_closing():
                return
            protocol = self.transport.get_protocol()
            receiver = super() if protocol is self else cast(asyncio.Protocol, protocol)
            receiver.data_received(data[at : at + _SLICE])
