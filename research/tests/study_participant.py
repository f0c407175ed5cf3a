"""A study to serve, its server in a process of its own, and a scripted participant without a browser."""

import json
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from latentarm_research.user_studies.catalogue import load_definition
from study_line import Line

CONTACT = "Ann Lee, ann@uni.example"
SCALE = {
    "name": "ease",
    "label": "Ease",
    "items": [{"text": f"Statement {number}.", "reversed": number > 2} for number in range(1, 5)],
    "points": 7,
}


def definition(*conditions: dict[str, Any]) -> dict[str, Any]:
    """A study with these conditions, one task and one scale."""
    given = load_definition("harmonic").as_json()
    return {
        **given,
        "name": "two_ways",
        "section": "",
        "papers_people": "",
        "people": 2,
        "practice_min": 0.0,
        "conditions": [
            {**given["conditions"][0], "assists": "none", "weight": 0.0, **one} for one in conditions
        ],
        "orders": [],
        "questionnaire": [SCALE],
        "measures": ["success_rate", "time_s", "input_magnitude", "path_length"],
        "hypotheses": [],
        "exclusions": [],
        "factors": [],
        "printed": [],
        "departures": [],
    }


DEVICE = {
    "browser": "Firefox 140",
    "webgl": True,
    "width_px": 1280,
    "height_px": 720,
    "inputs": ["mouse"],
    "round_trip_ms": 40.0,
    "jitter_ms": 8.0,
}
"""Results of a check that passes."""
MODES = {"name": "Modes", "about": "two axes at a time", "controls": "modes"}
TWIST = {"name": "Retargeting", "about": "the tool's twist", "controls": "retargeting"}
LATENT = {
    "name": "Latent",
    "about": "latent actions with shared autonomy",
    "controls": "latent",
    "model": "cvae",
    "context": ["joints", "belief"],
    "assists": "blending",
}


@contextmanager
def serving(study: str, *options: str) -> Generator[tuple[str, "subprocess.Popen[str]"]]:
    """`latentarm study serve` as long as the block lasts: its first link, and its process."""
    command = [sys.executable, "-m", "latentarm", "study", "serve", study, "--port", "0", "--json"]
    command += ["--preset", "smoke", "--contact", CONTACT, *options]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    try:
        yield json.loads(server.stdout.readline())["address"], server
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(30)
        server.stdout.close()


class Participant:
    """A browser without a screen: pages by HTTP, drives by the socket."""

    def __init__(self, address: str, delay_s: float = 0.0) -> None:
        self.delay_s = delay_s  # of the way to the server, and of that back, s
        self.origin = re.match(r"http://[^/]+", address)[0]  # type: ignore[index]
        self.client = httpx.Client(base_url=self.origin, headers={"origin": self.origin}, timeout=90.0)
        self.client.event_hooks = {"request": [lambda _: time.sleep(2.0 * delay_s)]}

    @property
    def page(self) -> str:
        return self.client.get("/study").text

    @property
    def part(self) -> str:
        return re.search(r'data-part="(\w+)"', self.page)[1]  # type: ignore[index]

    def post(self, to: str, **content: Any) -> httpx.Response:
        return self.client.post(f"/study/{to}", json=content)

    def consent(self) -> None:
        digest = re.search(r'data-digest="(\w+)"', self.page)[1]  # type: ignore[index]
        self.post("consent", digest=digest)
        assert self.part == "device"
        self.post("device", **DEVICE)
        assert self.part == "practice"

    def ready(self) -> None:
        self.post("ready")

    def answer(self) -> None:
        page = self.page
        items = re.findall(r'name="(\w+_\d+)" value="1"', page)
        order = int(re.search(r'data-order="(\d)"', page)[1])  # type: ignore[index]
        assert len(items) >= 4
        self.post("answers", order=order, answers=dict.fromkeys(items, 6))

    def take_part(self) -> None:
        """Do what is due until the study is over."""
        does = {
            "consent": self.consent,
            "practice": self.ready,
            "trial": self.try_drive,
            "questions": self.answer,
        }
        while (part := self.part) != "finished":
            does[part]()

    @contextmanager
    def connected(self, **options: Any) -> Generator[ClientConnection]:
        """The socket of the Drive page; ``options`` are those of its connection."""
        cookie = "; ".join(f"{name}={value}" for name, value in self.client.cookies.items())
        self.state: dict[str, Any] = {}
        self.told: list[str] = []
        with connect(
            f"ws{self.origin[4:]}/drive",
            origin=self.origin,  # type: ignore[arg-type]
            compression=None,
            additional_headers={"cookie": cookie},
            **options,
        ) as socket:
            self.listener = threading.Thread(target=self._listen, args=[socket], daemon=True)
            self.listener.start()
            try:
                with suppress(ConnectionClosed):
                    socket.send(json.dumps({"type": "hello", "version": 1}))
                yield socket
            finally:
                socket.close()
                self.listener.join()

    @contextmanager
    def driving(self) -> Generator[None]:
        """Begin the next drive, and enable the arm; then push until the study says that it is over.

        All of it goes over a line with this person's delay.
        """
        while (answer := self.post("begin")).status_code == 503:
            assert answer.json()["waits_s"] > 0
            time.sleep(1.0)
        assert answer.json()["to"] == "/"
        assert 'id="stick"' in self.client.get("/").text
        with Line(self.origin, self.delay_s) as line, self.connected(sock=line.end) as socket:
            enabled = ("ready", "moving")
            self.push(socket, lambda: bool(self.told) or self.state.get("phase") in enabled, [0.0, 0.0])
            yield
            self.push(socket, lambda: bool(self.told), [0.0, 1.0])

    def try_drive(self) -> None:
        """Drive until the study says that the drive is over, or the connection has ended."""
        with self.driving():
            pass

    def drive(self) -> None:
        """Drive until the study says that the drive is over."""
        self.try_drive()
        assert self.told == ["drive_over"]

    def _listen(self, socket: ClientConnection) -> None:
        with suppress(ConnectionClosed):
            for frame in socket:
                message = json.loads(frame)
                if message["type"] == "state":
                    self.state = message
                elif message["type"] == "refused":
                    self.told.append(message["notice"]["code"])

    def push(self, socket: ClientConnection, until: Callable[[], bool], u: list[float]) -> None:
        """Send this input until something is so; also enable the arm."""
        end_s, sent = time.monotonic() + 60.0, int(time.monotonic() * 1000)
        with suppress(ConnectionClosed):
            while not until() and self.listener.is_alive():
                assert time.monotonic() < end_s, f"it never came to that: {self.state}"
                enabled = self.state.get("phase") in ("ready", "moving")
                if self.state:
                    sent += 1
                    given = {
                        "seq": sent,
                        "nonce": self.state["nonce"],
                        "u": u if enabled else [0.0, 0.0],
                        "latched": False,
                    }
                    socket.send(json.dumps({"type": "input", "source": "pointer", "name": "mouse", **given}))
                    if not enabled and sent % 10 == 0:
                        socket.send(json.dumps({"type": "enable"}))
                time.sleep(0.02)


@contextmanager
def participant(address: str, link: str = "", delay_s: float = 0.0) -> Generator[Participant]:
    """Somebody with this link, at the server with this address; each way to it takes so long, s."""
    person = Participant(address, delay_s)
    with person.client:
        if link:
            person.client.get(link, follow_redirects=True)
        yield person


def next_link(out: Path, number: int = 1) -> str:
    """The link of this number in the study's list, from 0."""
    return (out / "links.csv").read_text().splitlines()[1 + number]
