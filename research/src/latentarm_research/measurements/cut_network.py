"""Between a page and its server: passes every byte on, until the network is cut."""

import socket
import threading
from contextlib import suppress
from typing import Final, final

_MOST: Final = 65536


@final
class Proxy:
    """Listens on a port of its own and passes bytes both ways.

    While it is cut no byte passes, and neither side is told: so it is when a cable is pulled.
    """

    def __init__(self, port: int) -> None:
        self._to = ("127.0.0.1", port)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listening.getsockname()[1])
        self._open: list[socket.socket] = []
        self._cut = threading.Event()
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Pass nothing on from now on."""
        self._cut.set()

    def mend(self) -> None:
        """Hang up on all who were cut off; new connections work again."""
        for one in self._open:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()
        self._open.clear()
        self._cut.clear()

    def close(self) -> None:
        """Take no more connections, and hang up."""
        self._listening.close()
        self.mend()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._listening.accept()
                far = socket.create_connection(self._to)
                self._open += [near, far]
                for one, other in ((near, far), (far, near)):
                    one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    threading.Thread(target=self._pass, args=[one, other], daemon=True).start()

    def _pass(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while heard := one.recv(_MOST):
                if not self._cut.is_set():
                    other.sendall(heard)
            if not self._cut.is_set():
                other.shutdown(socket.SHUT_WR)
