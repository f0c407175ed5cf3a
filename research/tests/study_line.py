"""A line between a participant and a study's server that delays what it carries, and can be cut."""

import select
import socket
import threading
import time
from collections import deque
from collections.abc import Generator
from contextlib import ExitStack, contextmanager, suppress
from typing import Self, final


@final
class Line:
    """Carries bytes both ways; once it is cut it carries nothing more, and neither end hears of it.

    Args:
        origin: of the server, ``http://HOST:PORT``.
        delay_s: how long each way takes, s.
        theirs: the server's end of a connection that a participant has made; None makes one, with `end`.
    """

    def __init__(self, origin: str, delay_s: float = 0.0, theirs: socket.socket | None = None) -> None:
        host, port = origin.removeprefix("http://").split(":")
        self.end, self._theirs = socket.socketpair() if theirs is None else (theirs, theirs)
        self._server = socket.create_connection((host, int(port)))
        self._server.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._delay_s = delay_s
        self._closed = threading.Event()
        self.cut = threading.Event()
        self._carrier = threading.Thread(target=self._carry, daemon=True)

    def __enter__(self) -> Self:
        self._carrier.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._carrier.join()
        for one in (self.end, self._theirs, self._server):
            one.close()

    def _carry(self) -> None:
        try:
            self._carry_until_cut()
        except OSError:
            # An end is gone, such as that of a killed server: the other one hears of it.
            for one in (self._theirs, self._server):
                with suppress(OSError):
                    one.shutdown(socket.SHUT_RDWR)
                one.close()

    def _carry_until_cut(self) -> None:
        under_way: deque[tuple[float, socket.socket, bytes]] = deque()
        ends = [self._theirs, self._server]
        while (ends or under_way) and not self._closed.is_set() and not self.cut.is_set():
            waits_s = 0.05 if not under_way else min(max(under_way[0][0] - time.monotonic(), 0.0), 0.05)
            for source in select.select(ends, [], [], waits_s)[0]:
                content = source.recv(1 << 16)
                target = self._server if source is self._theirs else self._theirs
                under_way.append((time.monotonic() + self._delay_s, target, content))
                if not content:
                    ends.remove(source)
            while under_way and under_way[0][0] <= time.monotonic():
                _, target, content = under_way.popleft()
                if not content:
                    target.shutdown(socket.SHUT_WR)
                target.sendall(content)
        if not ends:
            # Both have ended: browsers make a thousand connections.
            self._theirs.close()
            self._server.close()


@contextmanager
def far_away(origin: str, delay_s: float) -> Generator[int]:
    """A port at which the server at this origin answers, with so long a way there and back, s."""
    with ExitStack() as lines, socket.create_server(("127.0.0.1", 0)) as listening:

        def accept() -> None:
            with suppress(OSError):
                while True:
                    theirs, _ = listening.accept()
                    try:
                        lines.enter_context(Line(origin, delay_s, theirs))
                    except OSError:
                        # The server has refused one, which the browser hears; others go on.
                        theirs.close()

        accepting = threading.Thread(target=accept, daemon=True)
        accepting.start()
        try:
            yield listening.getsockname()[1]
        finally:
            listening.shutdown(socket.SHUT_RDWR)
            accepting.join()
