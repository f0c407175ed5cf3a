"""Measure how fast the page stops the arm when browser, network or server fail.

A real Chromium holds the stick of a real server's page; then comes the fault. Its time is taken just before
it is caused, those of the arm from the journal of the control process, on the same clock: from the fault to
the first command of zero after which there is no other, and until the arm is below 0.01 rad/s for good.
"""

import json
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray
from latentarm.recordings.journal_reader import JournalEpisode, read_journal
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm_research.measurements.bare_chromium import Browser, Proxy, Tab, browser
from latentarm_research.measurements.catalogue import PageStops
from latentarm_research.measurements.measurement import Outcome, Work, line

FAULTS: Final = (
    "pointer released outside the window",
    "tab hidden",
    "page closed",
    "network cut",
    "server blocked for 1 s",
    "browser killed",
)
WITHIN_MS: Final = {"zero_command": 150.0, "rest": 400.0}
BLOCKED_S: Final = 1.0  # longer than `SIMULATED_INPUT_BUDGET_S`: a shorter pause ends in motion again
WATCHED_S: Final = 0.7
MOVING_S: Final = 0.4
START_S: Final = 60.0
MOST_STARTS: Final = 10

DRAWN: Final = "document.querySelector('.label') && document.querySelector('#status[data-phase=disengaged]')"

DRIVE_SOCKET: Final = """{
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...words) {
      super(...words);
      if (this.url.endsWith("/drive")) window.drive = this;
    }
  };
}"""


def measure(options: PageStops, work: Work) -> Outcome:
    """Median, 95th percentile and worst of both times; void tries had stopped before their fault."""
    rows, broken = [], list[str]()
    for fault in options.faults or FAULTS:
        if fault not in FAULTS:
            raise UserError(f"There is no fault {fault!r}: choose from {', '.join(FAULTS)}.")
        times, void = list[tuple[float, float]](), 0
        while len(times) < options.tries:
            with tempfile.TemporaryDirectory() as out:
                faults_s = drives(options.run, Path(out), fault, options.tries - len(times))
                (journal,) = Path(out).glob("*.sqlite")
                halts = [halt(*one) for one in zip(read_journal(journal), faults_s, strict=True)]
            times += [one for one in halts if one is not None]
            void += halts.count(None)
        figures: dict[str, float] = {"void": void}
        for (name, most), times_s in zip(WITHIN_MS.items(), np.array(times).T, strict=True):
            for word, share in (("median", 50), ("p95", 95), ("worst", 100)):
                figures[f"{name}_{word}_ms"] = 1000.0 * float(np.percentile(times_s, share))
            late = int((1000.0 * times_s > most).sum())
            broken += [f"{fault}: {name} after more than {most:g} ms in {late} tries"] * bool(late)
        rows += line("page-stops", fault, len(times), figures)
    return Outcome(rows, broken)


@final
@dataclass(frozen=True)
class Scene:
    """The processes and connections that a fault can hit."""

    tab: Tab  # shows the page
    browser: Browser  # has the tab
    server: "subprocess.Popen[bytes]"  # `latentarm teleop`
    proxy: Proxy  # between them

    def suffer(self, fault: str) -> None:
        """Cause a fault."""
        match fault:
            case "pointer released outside the window":
                self.tab.mouse("mouseReleased", -80, -80)
            case "tab hidden":
                self.browser.to_front()
            case "page closed":
                self.tab.close()
            case "network cut":
                self.proxy.cut()
            case "server blocked for 1 s":
                self.server.send_signal(signal.SIGSTOP)
                time.sleep(BLOCKED_S)
                self.server.send_signal(signal.SIGCONT)
            case _:
                self.browser.kill()


def drives(run: Path, out: Path, fault: str, tries: int) -> list[float]:
    """Drive so many times, each until the fault; when it was caused, s. The journal is left in ``out``."""
    faults_s: list[float] = []
    with served(run, out) as (server, address):
        host = address.removeprefix("http://")
        proxy = Proxy(int(host.rsplit(":", 1)[1]))
        # Page and server still know each other by the server's own address.
        way = [f"--host-resolver-rules=MAP {host} 127.0.0.1:{proxy.port}"] if fault == "network cut" else []
        # Only a killed browser cannot be used again.
        per_browser = 1 if fault == "browser killed" else tries
        while len(faults_s) < tries:
            with browser(*way) as chromium:
                for _ in range(per_browser):
                    scene = Scene(chromium.open(address, DRIVE_SOCKET), chromium, server, proxy)
                    hold_stick(scene.tab)
                    faults_s.append(MonotonicClock().now_s())
                    scene.suffer(fault)
                    time.sleep(WATCHED_S)
                    proxy.restore()
                    scene.tab.close()
                    # The episode ends with its driver.
                    time.sleep(0.3)
        proxy.close()
    return faults_s


@contextmanager
def served(run: Path, out: Path) -> "Generator[tuple[subprocess.Popen[bytes], str]]":
    """`latentarm teleop RUN` and its address; what is recorded goes to ``out``."""
    command = [sys.executable, "-m", "latentarm", "teleop", str(run), "--port", "0", "--out", str(out)]
    with (out / "said").open("wb") as file:
        server = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT)
    try:
        end_s, address = time.monotonic() + START_S, None
        while address is None:
            if time.monotonic() > end_s or server.poll() is not None:
                raise UserError(f"The server did not start: {(out / 'said').read_text()[:500]}")
            time.sleep(0.1)
            address = re.search(r"http://[\d.]+:\d+", (out / "said").read_text())
        yield server, address.group()
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(20)


def hold_stick(tab: Tab) -> None:
    """Enable the arm, and push the stick until it has moved for a while; an episode is recorded of it."""
    if not tab.wait(DRAWN, 30.0):
        raise UserError("The page does not come up: " + str(tab.evaluate("document.body.innerText"))[:500])
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
    raise UserError(
        "The arm never moves: " + str(tab.evaluate("document.getElementById('status').innerText"))
    )


def send(tab: Tab, kind: str, **fields: object) -> None:
    """Say something to the server in the page's name."""
    tab.evaluate(f"drive.send({json.dumps(json.dumps({'type': kind, **fields}))})")


def halt(episode: JournalEpisode, fault_s: float) -> tuple[float, float] | None:
    """Times from a fault to the last command and to rest, s; None where the arm had stopped before it."""
    times = np.array([record.time_s for record in episode.records])
    commands = np.array([np.abs(record.command.velocity).max() for record in episode.records])
    moves = np.abs(np.diff([record.state for record in episode.records], axis=0)).max(axis=1)
    # From each sample to the next; after the last one the arm follows its last command.
    speeds = np.append(moves / np.diff(times), commands[-1])
    if commands[times <= fault_s][-1] < STILL_RAD_S:
        return None
    if commands[-1] > 0.0:
        raise RuntimeError(f"the arm never stopped after the fault in the episode {episode.header.task!r}")
    return first_after(times, commands > 0.0) - fault_s, first_after(times, speeds > STILL_RAD_S) - fault_s


def first_after(times: FloatArray, moving: BoolArray) -> float:
    """When the first sample after the last that moved was taken, s."""
    return float(times[np.flatnonzero(moving)[-1] + 1])
