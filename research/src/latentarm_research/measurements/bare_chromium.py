"""A Chromium over the bare DevTools protocol: here a tab behind another one really is hidden.

Playwright tells every page that it is visible.

`Proxy` stands between a page and its server: it passes every byte on, until the network is cut.
"""

import http.client
import itertools
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from latentarm.core.errors import UserError
from latentarm_research.studies.page import NAMES, browser_rights, find_browser

ARGUMENTS: Final = (
    "--headless=new",
    "--no-first-run",
    "--remote-debugging-port=0",
    "--window-size=1280,900",
    # It draws without a graphics processor.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
START_S: Final = 30.0
ANSWER_S: Final = 20.0


@final
@dataclass(frozen=True)
class Tab:
    """One tab of a `Browser`."""

    socket: ClientConnection
    numbers: Iterator[int]

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command of the protocol and wait until it is done."""
        number = self.tell(method, **parameters)
        while True:
            answer = json.loads(self.socket.recv(timeout=ANSWER_S))
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def tell(self, method: str, **parameters: Any) -> int:
        """Send a command of the protocol; its number."""
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        return number

    def evaluate(self, script: str) -> Any:
        """Value of a script in the tab."""
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait(self, condition: str, within_s: float) -> bool:
        """Wait for a condition in the tab, a JavaScript expression; return whether it came true in time."""
        end_s = time.monotonic() + within_s
        while time.monotonic() < end_s:
            if self.evaluate(f"Boolean({condition})"):
                return True
            time.sleep(0.02)
        return False

    def mouse(self, kind: str, x: float, y: float) -> None:
        """``mousePressed``, ``mouseMoved`` or ``mouseReleased``, with the left button."""
        held = 0 if kind == "mouseReleased" else 1
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=held, clickCount=1)

    def close(self) -> None:
        """Close the tab, where it is still there."""
        with suppress(ConnectionClosed):
            self.tell("Page.close")
        self.socket.close()


@final
class Browser:
    """A running Chromium and its tabs."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        found = find_browser()
        if found is None:
            raise UserError(f"No Chromium is installed: looked for {', '.join(NAMES)}.")
        command = [
            found,
            *ARGUMENTS,
            *browser_rights(),
            f"--user-data-dir={folder}",
            *arguments,
            "about:blank",
        ]
        self.process = subprocess.Popen(
            command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self._numbers = itertools.count()
        self._port = _debugging_port(folder / "DevToolsActivePort")

    def open(self, address: str, script: str) -> Tab:
        """A new tab in front of the others; ``script`` runs before those of the page."""
        target = self._ask("new?about:blank", "PUT")
        tab = Tab(connect(target["webSocketDebuggerUrl"]), self._numbers)
        tab.ask("Page.enable")
        tab.ask("Page.addScriptToEvaluateOnNewDocument", source=script)
        tab.ask("Page.navigate", url=address)
        return tab

    def to_front(self) -> None:
        """Show the first tab, which is empty; all others are hidden by that."""
        first = next(one for one in self._ask("list") if one["url"] == "about:blank")
        self._ask(f"activate/{first['id']}")

    def kill(self) -> None:
        """End it and all its processes without warning."""
        os.killpg(self.process.pid, signal.SIGKILL)

    def _ask(self, what: str, method: str = "GET") -> Any:
        line = http.client.HTTPConnection("127.0.0.1", self._port, timeout=ANSWER_S)
        line.request(method, f"/json/{what}")
        text = line.getresponse().read().decode()
        line.close()
        return json.loads(text) if text.startswith(("{", "[")) else text


@contextmanager
def browser(*arguments: str) -> Generator[Browser]:
    """A Chromium as long as the block lasts."""
    folder = Path(tempfile.mkdtemp())
    running = Browser(folder, *arguments)
    try:
        yield running
    finally:
        if running.process.poll() is None:
            running.kill()
        running.process.wait()
        shutil.rmtree(folder, ignore_errors=True)


def _debugging_port(file: Path) -> int:
    end_s = time.monotonic() + START_S
    while time.monotonic() < end_s:
        if file.exists() and (words := file.read_text().split()):
            return int(words[0])
        time.sleep(0.05)
    raise UserError("Chromium did not start.")


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

    def restore(self) -> None:
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
        self.restore()

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
