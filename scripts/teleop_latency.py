"""Times of the teleoperation page's server, on this machine, with WebSocket clients in place of browsers.

Three tables: from a page's input to the first state that shows motion; how many deadlines of the 100 Hz loop
are met with 1 page and with 10; and from a fault to zero command and to rest, by the control process's own
clock (the journal that it writes; Linux has one such clock for all processes). For example:

    python scripts/teleop_latency.py --inputs 500 --tries 20 --out teleop-latency.json
"""

import argparse
import asyncio
import json
import multiprocessing
import os
import signal
import tempfile
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import uvicorn
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from latentarm.control.clock import MonotonicClock
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.process import ControlProcess
from latentarm.web.records.calendar import SYSTEM_CALENDAR
from latentarm.web.server.addresses import TeleopConfig, listen
from latentarm.web.server.app import build_app, gated, serve_on, server_config
from latentarm.web.server.connections import ConnectionLimits
from teleop_journal import Halt, halts, spread

FAULTS = ("inputs cease", "socket closed", "event loop blocked", "server killed")
INPUT_PERIOD_S = 0.02


@dataclass
class Page:
    """A page without a browser: listens in one thread, sends inputs at 50 Hz in another."""

    port: int
    u: list[float] | None = None
    state: dict[str, Any] = field(default_factory=dict)
    sequence: int = 0
    open: bool = True
    moved: threading.Event = field(default_factory=threading.Event)

    def __enter__(self) -> "Page":
        self.context = connect(
            f"ws://127.0.0.1:{self.port}/drive", origin=f"http://127.0.0.1:{self.port}", compression=None
        )
        self.socket: ClientConnection = self.context.__enter__()
        self.lock = threading.Lock()
        self.send(type="hello", version=1)
        self.threads = [threading.Thread(target=work, daemon=True) for work in (self.hear, self.talk)]
        for thread in self.threads:
            thread.start()
        while not self.state:
            time.sleep(0.01)
        return self

    def __exit__(self, *exception: object) -> None:
        self.open = False
        self.context.__exit__(None, None, None)
        for thread in self.threads:
            thread.join()

    def send(self, **message: Any) -> None:
        """Send a message."""
        with self.lock:
            self.socket.send(json.dumps(message))

    def hear(self) -> None:
        """Keep the newest state."""
        with suppress(ConnectionClosed):
            for frame in self.socket:
                message = json.loads(frame)
                if message["type"] == "state":
                    before, self.state = self.state, message
                    if before and before["bodies"] != message["bodies"]:
                        self.moved.set()
        self.open = False

    def talk(self) -> None:
        """Send inputs while the page is open."""
        with suppress(ConnectionClosed):
            while self.open:
                self.give()
                time.sleep(INPUT_PERIOD_S)

    def give(self) -> None:
        """Send one input."""
        if self.u is None or not self.state:
            return
        self.sequence += 1
        nonce = self.state["nonce"]
        self.send(type="input", seq=self.sequence, nonce=nonce, u=self.u, source="pointer", latched=False)

    def enable(self) -> None:
        """Let go and press Enable until it is."""
        self.u = [0.0, 0.0]
        while self.state["phase"] not in ("ready", "moving"):
            time.sleep(0.06)
            self.send(type="enable")
            time.sleep(0.1)

    def set_going(self, u: list[float]) -> None:
        """Enable and push, until the arm moves."""
        self.enable()
        self.u = u
        time.sleep(0.5)
        if self.state["phase"] != "moving":
            self.set_going(u)


def serve(spec: Spec, sender: Any) -> None:
    """A server in a process of its own, as `latentarm teleop` runs it but for NiceGUI's pages."""
    os.setsid()
    config = TeleopConfig(spec, port=0)
    listening = listen(config)
    port = int(listening.getsockname()[1])
    control = ControlProcess(spec)
    app = build_app(load_setup(spec), control, config, SYSTEM_CALENDAR)
    app = gated(app, control, config, port, None, lambda: "")
    server = uvicorn.Server(server_config(app, config))

    def block() -> None:
        sender.send(MonotonicClock().now_s())
        time.sleep(0.3)

    async def run() -> None:
        loop = asyncio.get_running_loop()
        loop.add_signal_handler(signal.SIGUSR1, block)
        sender.send((port, control.pid))
        await serve_on(listening, server, ConnectionLimits())

    asyncio.run(run())
    control.end()


class Server:
    """A running server."""

    def __init__(self, run: Path | None, out: Path) -> None:
        context = multiprocessing.get_context("spawn")
        receiver, sender = context.Pipe(duplex=False)
        self.out = out
        self.process = context.Process(target=serve, args=(Spec(run, out=out), sender))
        self.process.start()
        self.receiver = receiver
        self.port, self.control_pid = receiver.recv()

    def __enter__(self) -> "Server":
        return self

    def __exit__(self, *exception: object) -> None:
        if self.process.is_alive():
            self.process.terminate()
        self.process.join()
        while alive(self.control_pid):
            time.sleep(0.01)


def alive(pid: int) -> bool:
    """Whether there is a process of this id."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def input_to_motion(run: Path | None, inputs: int) -> list[float]:
    """Times from an input to the first state in which the arm stands elsewhere, s."""
    rng = np.random.default_rng(0)
    times: list[float] = []
    with tempfile.TemporaryDirectory() as out, Server(run, Path(out)) as server, Page(server.port) as page:
        while len(times) < inputs:
            page.enable()
            time.sleep(float(rng.uniform(0.25, 0.30)))
            if page.state["phase"] != "ready":
                continue
            page.moved.clear()
            page.u = [1.0 if len(times) % 2 else -1.0, 0.0]
            began_s = time.monotonic()
            page.give()
            if page.moved.wait(1.0):
                times.append(time.monotonic() - began_s)
            page.u = [0.0, 0.0]
            time.sleep(0.15)
    return times


def deadlines(run: Path | None, pages: int, for_s: float) -> dict[str, float]:
    """Share of deadlines met while one page drives and the others watch."""
    with tempfile.TemporaryDirectory() as out, Server(run, Path(out)) as server:
        watchers = [Page(server.port) for _ in range(pages - 1)]
        with Page(server.port) as driver:
            for page in watchers:
                page.__enter__()
            driver.set_going([1.0, 0.0])
            began = driver.state["tick"]
            end_s = time.monotonic() + for_s
            while time.monotonic() < end_s:
                time.sleep(1.5)
                driver.set_going([-driver.u[0] if driver.u else 1.0, 0.0])
            ticks, late = driver.state["tick"] - began, driver.state["late_share"]
            for page in watchers:
                page.__exit__()
    return {"pages": pages, "ticks": ticks, "met_share": 1.0 - late}


def fault_times(run: Path | None, fault: str, tries: int) -> tuple[list[Halt], int]:
    """How the arm stopped after a fault, once for each try; and how many tries were void.

    A try is void where the arm had stopped for another reason just before the fault.
    """
    found: list[Halt] = []
    void = 0
    while len(found) < tries:
        # Only a killed server cannot be used again.
        at_once = 1 if fault == "server killed" else tries - len(found)
        with tempfile.TemporaryDirectory() as out:
            with Server(run, Path(out)) as server:
                faults_s = [one_fault(server, fault) for _ in range(at_once)]
            (journal,) = Path(out).glob("*.sqlite")
            times = halts(journal, faults_s)
        found += [one for one in times if one is not None]
        void += times.count(None)
    return found, void


def one_fault(server: Server, fault: str) -> float:
    """Drive, let the fault happen, and wait for what comes of it; when it happened, s."""
    with suppress(ConnectionClosed), Page(server.port) as page:
        page.send(type="record", on=True, task=fault)
        page.set_going([1.0, 0.0])
        fault_s = MonotonicClock().now_s()
        match fault:
            case "inputs cease":
                page.u = None
            case "socket closed":
                page.socket.close()
            case "event loop blocked":
                os.kill(server.process.pid or 0, signal.SIGUSR1)
                fault_s = server.receiver.recv()
            case "server killed":
                server.process.kill()
            case _:
                raise ValueError(fault)
        time.sleep(0.7)
    if fault != "server killed":
        with Page(server.port) as page:
            page.send(type="record", on=False)
            page.send(type="reset")
            time.sleep(0.3)
    return fault_s


def main() -> None:
    """Measure what was asked for, and write it after every table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--run", type=Path, help="a trained run; the end-effector is driven without one")
    parser.add_argument("--inputs", type=int, default=500)
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=30.0, help="of driving, for the deadlines")
    parser.add_argument("--faults", nargs="*", choices=FAULTS, default=FAULTS)
    parser.add_argument("--out", type=Path, default=Path("teleop-latency.json"))
    chosen = parser.parse_args()
    results: dict[str, Any] = {"cores": os.cpu_count(), "load": os.getloadavg()}

    def tell(name: str, figures: dict[str, Any]) -> None:
        results[name] = figures
        print(f"{name}: {figures}", flush=True)
        chosen.out.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")

    if chosen.inputs:
        tell("input to motion", spread(input_to_motion(chosen.run, chosen.inputs)))
    if chosen.seconds:
        for pages in (1, 10):
            tell(f"deadlines, {pages} pages", deadlines(chosen.run, pages, chosen.seconds))
    for fault in chosen.faults:
        if chosen.tries:
            times, void = fault_times(chosen.run, fault, chosen.tries)
            tell(f"{fault}, to zero command", spread([one.zero_s for one in times]) | {"void": void})
            tell(f"{fault}, to rest", spread([one.rest_s for one in times]))


if __name__ == "__main__":
    main()
