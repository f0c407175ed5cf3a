"""Stop and driving while somebody floods the page's server: idle connections, and headers without an end.

A real `latentarm teleop`, a page without a browser that drives, and two processes that attack.
One holds half-sent requests open and renews those that are closed; the other sends headers of many megabytes,
one after the other. First the page drives back and forth, then Stop is posted again and again while the arm
moves. For example:

    python scripts/teleop_flood.py --idle 500 --headers-mb 20 --stops 50 --out flood.json
"""

import argparse
import json
import multiprocessing
import os
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from teleop_journal import halts, spread
from teleop_latency import Page

RENEW_EVERY_S = 0.2
LOOK_EVERY_S = 0.05
PATIENCE_S = 30.0


@dataclass(frozen=True)
class Server:
    """A running `latentarm teleop`."""

    pid: int
    port: int

    @property
    def memory_mb(self) -> float:
        """What its own process holds in memory."""
        pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="ascii").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


@contextmanager
def serving(out: Path) -> Iterator[Server]:
    """`latentarm teleop` without a run, from its first word until it has ended."""
    words = [sys.executable, "-m", "latentarm", "teleop", "--port", "0", "--json", "--out", str(out)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            said = "" if process.stdout is None else process.stdout.readline()
            address = json.loads(said)["address"]
            port = urlsplit(address).port or 0
            until_s = time.monotonic() + PATIENCE_S
            while status(port, "/", "GET") != 200:
                if time.monotonic() > until_s:
                    raise TimeoutError("the page is not served")
                time.sleep(LOOK_EVERY_S)
            yield Server(process.pid, port)
        finally:
            process.send_signal(signal.SIGINT)


def status(port: int, path: str, method: str) -> int | None:
    """Status of an answer; None where there was none."""
    line = HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    try:
        line.request(method, path, headers={"Origin": f"http://127.0.0.1:{port}"})
        return line.getresponse().status
    except OSError:
        return None
    finally:
        line.close()


def hold_idle(port: int, number: int, opened: Any) -> None:
    """Keep so many half-sent requests open; those that the server closes are opened again."""
    watching = selectors.DefaultSelector()
    while True:
        for key, _ in watching.select(timeout=0):
            watching.unregister(key.fileobj)
            key.fileobj.close()  # pyright: ignore
        for _ in range(number - len(watching.get_map())):
            with suppress(OSError):
                line = socket.create_connection(("127.0.0.1", port), timeout=5)
                line.sendall(b"GET / HTTP/1.1\r\nHost: ")
                watching.register(line, selectors.EVENT_READ)
                opened.value += 1
        time.sleep(RENEW_EVERY_S)


def send_headers(port: int, size: int, sent: Any) -> None:
    """Send one header after the other of so many bytes, each as far as the server takes it."""
    piece = b"a" * 65536
    while True:
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=5) as line:
            line.sendall(b"GET / HTTP/1.1\r\nX: ")
            for _ in range(size // len(piece)):
                line.sendall(piece)
                sent.value += len(piece)
        time.sleep(LOOK_EVERY_S)


@contextmanager
def attacked(port: int, idle: int, header_bytes: int) -> Iterator[dict[str, Any]]:
    """Both attacks, in processes of their own; yields their counters."""
    context = multiprocessing.get_context("spawn")
    counters = {"idle connections opened": context.Value("q", 0), "header bytes taken": context.Value("q", 0)}
    attacks = [
        context.Process(target=hold_idle, args=(port, idle, counters["idle connections opened"])),
        context.Process(target=send_headers, args=(port, header_bytes, counters["header bytes taken"])),
    ]
    for attack, wanted in zip(attacks, (idle, header_bytes), strict=True):
        if wanted:
            attack.start()
    try:
        until_s = time.monotonic() + PATIENCE_S
        while counters["idle connections opened"].value < idle and time.monotonic() < until_s:
            time.sleep(LOOK_EVERY_S)
        yield counters
    finally:
        for attack in attacks:
            if attack.pid is not None:
                attack.kill()
                attack.join()


def drive(page: Page, for_s: float) -> dict[str, Any]:
    """Drive back and forth; how often the arm stopped although nobody had pressed Stop, and why."""
    page.set_going([1.0, 0.0])
    began = page.state["tick"]
    why: list[str] = []
    until_s = time.monotonic() + for_s
    turn_s = time.monotonic() + 1.5
    while time.monotonic() < until_s and page.open:
        if page.state["phase"] not in ("ready", "moving"):
            why.append(str(page.state["reason"]))
            page.set_going([1.0, 0.0])
        if time.monotonic() > turn_s and page.u:
            page.u = [-page.u[0], 0.0]
            turn_s += 1.5
        time.sleep(0.01)
    return {"seconds": for_s, "ticks": page.state["tick"] - began, "stops": len(why), "why": sorted(set(why))}


def press_stop(page: Page, port: int, stops: int) -> tuple[list[float], list[float], list[int | None]]:
    """Set going and post Stop, so often: when it was posted, how long the answer took, s, and its status."""
    posted_s: list[float] = []
    answered_s: list[float] = []
    statuses: list[int | None] = []
    for number in range(stops):
        page.send(type="record", on=True, task=f"stop {number}")
        page.set_going([1.0 if number % 2 else -1.0, 0.0])
        posted_s.append(time.monotonic())
        statuses.append(status(port, "/stop", "POST"))
        answered_s.append(time.monotonic() - posted_s[-1])
        time.sleep(0.4)
        page.send(type="record", on=False)
        time.sleep(0.2)
    return posted_s, answered_s, statuses


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--idle", type=int, default=500, help="connections that never finish a request")
    parser.add_argument("--headers-mb", type=int, default=20, help="length of one header; 0 sends none")
    parser.add_argument("--stops", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=20.0, help="of driving before that")
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args()
    figures: dict[str, Any] = {"cores": os.cpu_count(), "load": os.getloadavg()}
    with tempfile.TemporaryDirectory() as folder:
        with serving(Path(folder)) as server:
            memory_mb = server.memory_mb
            attack = attacked(server.port, chosen.idle, chosen.headers_mb * 10**6)
            with Page(server.port) as page, attack as counters:
                figures["driving"] = drive(page, chosen.seconds)
                posted_s, answered_s, statuses = press_stop(page, server.port, chosen.stops)
                figures |= {name: counter.value for name, counter in counters.items()}
                figures["memory grew by, MB"] = round(server.memory_mb - memory_mb, 1)
        (journal,) = Path(folder).glob("*.sqlite")
        found = [one for one in halts(journal, posted_s) if one is not None]
    figures["answered 204"] = statuses.count(204)
    figures["post to answer"] = spread(answered_s)
    figures["post to zero command"] = spread([one.zero_s for one in found])
    text = json.dumps(figures, indent=2)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
