"""Measure how many people one machine serves in a study: scripted ones drive at once, each an arm in physics.

The server is that of `latentarm study serve`. Drives begin one after another, push all the time and last
until their time is over, so that some begin while others are under way, as with people. The scripted people
share the processors with the server; real ones bring their own.
"""

import json
import math
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import replace
from http.client import HTTPConnection
from pathlib import Path
from typing import Any, Final, Never, final

import numpy as np
from websockets.exceptions import ConnectionClosedError, ConnectionClosedOK
from websockets.sync.client import ClientConnection, connect

from latentarm.core.errors import UserError
from latentarm_research.measurements.catalogue import StudyLoad
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.user_studies.catalogue import load_definition

MOST_MISSED_PERCENT: Final = 1.0
MOST_BROKEN_OFF: Final = 3
STUDY: Final = "eating"
NO_MODEL: Final = "retargeting"  # conditions that are driven so need no training
DEVICE: Final = {
    "browser": "",
    "webgl": True,
    "width_px": 1280,
    "height_px": 720,
    "inputs": ["mouse"],
    "round_trip_ms": 1.0,
    "jitter_ms": 0.0,
}
TRIAL: Final = 'data-part="trial"'
INPUT_S: Final = 0.02  # between two inputs, as on the page
TURN_S: Final = 4.0  # in which the stick goes round once


def measure(options: StudyLoad, work: Work) -> Outcome:
    """Share of missed deadlines of the arms' loops, by the number of people."""
    longest_s = min(one.trial_s for one in load_definition(STUDY).tasks)
    if min(options.people, default=0) < 1 or not 1.0 <= options.seconds <= longest_s:
        raise UserError(f"--people must be 1 or more, and --seconds from 1 to {longest_s:g}.")
    rows, broken = [], list[str]()
    for people in options.people:
        figures = load(people, options.seconds, np.random.default_rng(work.seed))
        rows += line("study-load", f"{people} at once", people, figures)
        if figures["missed_worst_percent"] > MOST_MISSED_PERCENT or figures["broken_off"]:
            what = f"a drive missed over {MOST_MISSED_PERCENT:g} % of its deadlines, or was broken off"
            broken.append(f"{people} at once: {what}")
    return Outcome(rows, broken)


def load(people: int, drive_s: float, rng: np.random.Generator) -> dict[str, float]:
    """So many people drive at the same time, each at every task of the study in one condition."""
    with tempfile.TemporaryDirectory() as folder, served(Path(folder), people, drive_s) as links:
        drivers = [Person(link) for link in links]
        for one in drivers:
            one.prepare()
        used_s, began_s = time.process_time(), time.monotonic()
        with ThreadPoolExecutor(people) as pool:
            list(pool.map(Person.take_part, drivers, rng.uniform(0.0, drive_s, people).tolist()))
        used_percent = 100.0 * (time.process_time() - used_s) / (time.monotonic() - began_s)
    missed = [share for one in drivers for share in one.missed] or [1.0]
    return {
        "missed_percent": 100.0 * sum(missed) / len(missed),
        "missed_worst_percent": 100.0 * max(missed),
        "stops": sum(one.stops for one in drivers),
        "broken_off": sum(one.broken_off for one in drivers),
        "longest_beginning_s": max(one.beginning_s for one in drivers),
        "scripted_people_percent": used_percent,
    }


@contextmanager
def served(folder: Path, people: int, drive_s: float) -> Generator[list[str]]:
    """A study in which so many may drive at the same time: their links."""
    whole = load_definition(STUDY)
    definition = replace(
        whole,
        name="load",
        people=max(people, 2),  # as a study must have
        conditions=tuple(one for one in whole.conditions if one.controls == NO_MODEL),
        tasks=tuple(replace(one, trial_s=drive_s) for one in whole.tasks),
        hypotheses=(),
        factors=(),
        printed=(),
    )
    study, out, said = folder / "load.json", folder / "people", folder / "said"
    study.write_text(json.dumps(definition.as_json()))
    command = [sys.executable, "-m", "latentarm", "study", "serve", str(study), "--out", str(out), "--json"]
    command += ["--port", "0", "--at-once", str(people), "--contact", "nobody"]
    with said.open("wb") as file:
        server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=file, text=True)
    try:
        if server.stdout is None or not server.stdout.readline():
            raise UserError(f"The study did not start: {said.read_text()[:500]}")
        yield (out / "links.csv").read_text().split()[1 : people + 1]
    finally:
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=60)


@final
class Person:
    """A scripted participant without a browser.

    Attributes:
        missed: the share of missed deadlines of each drive that lasted until its time was over.
        stops: how often the arm stopped and was enabled again.
        broken_off: the number of drives that ended earlier.
        beginning_s: the longest time from asking for a drive to the arm's first report, s.
    """

    def __init__(self, link: str) -> None:
        self.missed: list[float] = []
        self.stops = self.broken_off = 0
        self.beginning_s = 0.0
        self._origin, _, code = link.partition("/study")
        self._cookie = ""
        self._page(code)

    def prepare(self) -> None:
        """Do all that comes before the first drive."""
        (digest,) = re.findall(r'data-digest="(\w+)"', self._page())
        self.post("consent", digest=digest)
        self._page()  # it gives them their place
        self.post("device", **DEVICE)
        self.post("ready")
        if TRIAL not in self._page():
            raise RuntimeError("no drive is due after the practice")

    def post(self, to: str, **content: Any) -> dict[str, Any]:
        """Send something; the server's answer, which may be a refusal."""
        return json.loads(self._ask("POST", f"/study/{to}", json.dumps(content)))

    def take_part(self, begin_s: float) -> None:
        """Wait, s, then do all tasks in one condition, or give up where drives are broken off."""
        time.sleep(begin_s)
        while TRIAL in self._page() and self.broken_off < MOST_BROKEN_OFF:
            asked_s = time.monotonic()
            self.post("begin")
            try:
                self._drive(asked_s)
            except (ConnectionClosedError, TimeoutError):
                self.broken_off += 1

    def _page(self, query: str = "") -> str:
        return self._ask("GET", f"/study{query}")

    def _ask(self, method: str, path: str, content: str | None = None) -> str:
        connection = HTTPConnection(self._origin.partition("//")[2])
        headers = {"content-type": "application/json", "origin": self._origin, "cookie": self._cookie}
        try:
            connection.request(method, path, content, headers)
            answer = connection.getresponse()
            given = [one.partition(";")[0] for one in answer.headers.get_all("set-cookie", ())]
            self._cookie = "; ".join(given) or self._cookie
            return answer.read().decode()
        finally:
            connection.close()

    def _drive(self, asked_s: float) -> None:
        with connect(
            f"ws{self._origin.removeprefix('http')}/drive",
            origin=self._origin,  # pyright: ignore[reportArgumentType]
            compression=None,
            additional_headers={"cookie": self._cookie},
        ) as socket:
            counts: list[tuple[int, float]] = []
            with suppress(ConnectionClosedOK):
                socket.send(json.dumps({"type": "hello", "version": 1}))
                self._push(socket, counts, asked_s)
        if len(counts) < 2:
            self.broken_off += 1
            return
        (first, late_before), (last, late) = counts[0], counts[-1]
        self.missed.append((late - late_before) / (last - first))

    def _push(self, socket: ClientConnection, counts: list[tuple[int, float]], asked_s: float) -> Never:
        """Enable the arm, and push in all directions until the server closes the connection.

        Notes ticks, and how many of them were late, while the arm is enabled.
        """
        state: dict[str, Any] = {}
        sent, due_s, enabled = 0, time.monotonic(), False
        while True:
            if state and time.monotonic() >= due_s:
                angle = 2.0 * math.pi * due_s / TURN_S
                u = [math.cos(angle), math.sin(angle)] if enabled else [0.0, 0.0]
                sent, due_s = sent + 1, due_s + INPUT_S
                given = {"seq": sent, "nonce": state["nonce"], "u": u, "latched": False}
                socket.send(json.dumps({"type": "input", "source": "pointer", "name": "mouse", **given}))
                if not enabled and sent % 10 == 0:
                    socket.send(json.dumps({"type": "enable"}))
            try:
                message = json.loads(socket.recv(timeout=max(due_s - time.monotonic(), 0.0)))
            except TimeoutError:
                continue
            if message["type"] == "state":
                if not state:
                    self.beginning_s = max(self.beginning_s, time.monotonic() - asked_s)
                    due_s = time.monotonic()
                state, before = message, enabled
                enabled = state["phase"] in ("ready", "moving")
                self.stops += bool(counts) and enabled and not before
                if enabled:
                    counts.append((state["tick"], state["tick"] * state["late_share"]))
