"""How fast the arm stops when something happens to the browser in front of it, the network or the server.

A real Chromium holds the stick of a real server's page; then comes the fault. Its time is taken just before
it is caused, those of the arm from the journal of the control process: from the fault to the first command of
zero after which there is no other, and until the arm is below 0.01 rad/s for good. For example:

    python scripts/teleop_browser_faults.py RUN --tries 20 --out teleop-browser-faults.json
"""

import argparse
import json
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from latentarm.control.clock import MonotonicClock
from teleop_chromium import Browser, Tab, browser
from teleop_journal import Halt, halts, spread
from teleop_page import Site, served
from teleop_proxy import Proxy

ZERO_WITHIN_S = 0.15
REST_WITHIN_S = 0.4
BLOCKED_S = 0.3
WATCHED_S = 0.7
MOVING_S = 0.4
MOST_STARTS = 10

DRIVE_SOCKET = """{
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...words) {
      super(...words);
      if (this.url.endsWith("/drive")) window.drive = this;
    }
  };
}"""


@dataclass
class Scene:
    """What a fault can happen to."""

    browser: Browser
    site: Site
    proxy: Proxy

    def __post_init__(self) -> None:
        self.tab = self.browser.open(self.site.address, DRIVE_SOCKET)


def released(scene: Scene) -> None:
    """The pointer is let go outside the window."""
    scene.tab.mouse("mouseReleased", -80, -80)


def hidden(scene: Scene) -> None:
    """Another tab comes to the front."""
    scene.browser.to_front()


def closed(scene: Scene) -> None:
    """The page is closed."""
    scene.tab.close()


def cut(scene: Scene) -> None:
    """No byte passes any more between page and server, and nobody is told."""
    scene.proxy.cut()


def blocked(scene: Scene) -> None:
    """The web server's process stands still for 300 ms, and goes on."""
    os.kill(scene.site.pid, signal.SIGSTOP)
    time.sleep(BLOCKED_S)
    os.kill(scene.site.pid, signal.SIGCONT)


def killed(scene: Scene) -> None:
    """All processes of the browser are killed."""
    scene.browser.kill()


FAULTS: dict[str, Callable[[Scene], None]] = {
    "pointer released outside the window": released,
    "tab hidden": hidden,
    "page closed": closed,
    "network cut": cut,
    "server blocked for 300 ms": blocked,
    "browser killed": killed,
}


def measure(run: Path, fault: str, tries: int) -> tuple[list[Halt], int]:
    """How the arm stopped, once for each try, and how many tries were void.

    A try is void where the arm had stopped for another reason just before the fault.
    """
    found: list[Halt] = []
    void = 0
    while len(found) < tries:
        with tempfile.TemporaryDirectory() as out:
            faults_s = drives(run, Path(out), fault, tries - len(found))
            (journal,) = Path(out).glob("*.sqlite")
            times = halts(journal, faults_s)
        found += [one for one in times if one is not None]
        void += times.count(None)
    return found, void


def drives(run: Path, out: Path, fault: str, tries: int) -> list[float]:
    """Drive so many times, each until the fault; when it was caused, s. The journal is left in ``out``."""
    faults_s: list[float] = []
    with served(run, out) as site:
        host = site.address.removeprefix("http://")
        proxy = Proxy(int(host.rsplit(":", 1)[1]))
        # Page and server still know each other by the server's own address.
        way = [f"--host-resolver-rules=MAP {host} 127.0.0.1:{proxy.port}"] if fault == "network cut" else []
        # Only a killed browser cannot be used again.
        per_browser = 1 if fault == "browser killed" else tries
        while len(faults_s) < tries:
            with browser(*way) as chromium:
                faults_s += [one(Scene(chromium, site, proxy), fault) for _ in range(per_browser)]
        proxy.close()
    return faults_s


def one(scene: Scene, fault: str) -> float:
    """Drive, cause the fault, and wait for what comes of it; when it was caused, s."""
    hold_stick(scene.tab)
    fault_s = MonotonicClock().now_s()
    FAULTS[fault](scene)
    time.sleep(WATCHED_S)
    scene.proxy.mend()
    scene.tab.close()
    # The episode ends with its driver.
    time.sleep(0.3)
    return fault_s


def hold_stick(tab: Tab) -> None:
    """Enable the arm, and push the stick until it has moved for a while; an episode is recorded of it."""
    if not tab.wait(
        "document.querySelector('.label') && document.querySelector('#status[data-phase=disengaged]')", 30.0
    ):
        raise SystemExit("The page does not come up: " + str(tab.evaluate("document.body.innerText"))[:500])
    send(tab, "ask_to_drive")
    send(tab, "reset")
    time.sleep(0.3)
    send(tab, "record", on=True, task="fault")
    box = tab.evaluate(
        "(box => [box.x + box.width / 2, box.y + box.height / 2, box.width])"
        "(document.getElementById('stick').getBoundingClientRect())"
    )
    for _ in range(MOST_STARTS):
        tab.evaluate("document.getElementById('enable').click()")
        if not tab.wait("document.querySelector('#status[data-phase=ready]')", 1.5):
            continue
        tab.mouse("mousePressed", box[0], box[1])
        tab.mouse("mouseMoved", box[0] - 0.3 * box[2], box[1])
        time.sleep(MOVING_S)
        if tab.evaluate("document.getElementById('status').dataset.phase") == "moving":
            return
        tab.mouse("mouseReleased", box[0], box[1])
    raise SystemExit(
        "The arm never moves: " + str(tab.evaluate("document.getElementById('status').innerText"))
    )


def send(tab: Tab, kind: str, **fields: object) -> None:
    """Say something to the server in the page's name."""
    tab.evaluate(f"drive.send({json.dumps(json.dumps({'type': kind, **fields}))})")


def main() -> None:
    """Measure, print and write; fails where a try was over a limit."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--faults", nargs="*", choices=FAULTS, default=list(FAULTS))
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    table = Table(
        "ms from the fault to",
        "n",
        "void",
        "zero: median",
        "p95",
        "worst",
        "rest: median",
        "p95",
        "worst",
        "over",
    )
    results: dict[str, object] = {"cores": os.cpu_count(), "load": os.getloadavg()}
    missed = 0
    for fault in given.faults:
        times, void = measure(given.run, fault, given.tries)
        over = sum(time.zero_s > ZERO_WITHIN_S or time.rest_s > REST_WITHIN_S for time in times)
        zero, rest = spread([time.zero_s for time in times]), spread([time.rest_s for time in times])
        results[fault] = {"zero": zero, "rest": rest, "void": void, "over_the_limits": over}
        figures = [
            f"{spread[name]:.0f}" for spread in (zero, rest) for name in ("median_ms", "p95_ms", "worst_ms")
        ]
        table.add_row(fault, str(len(times)), str(void), *figures, str(over))
        missed += over
        if given.out:
            given.out.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    Console(width=110).print(table)
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
