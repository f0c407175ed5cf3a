import asyncio
import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import uvicorn
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from latentarm.arms.catalogue import make_arm
from latentarm.arms.contract import Arm
from latentarm.control.clock import Clock, SimulatedClock
from latentarm.core.types import GripperAsk
from latentarm.demonstrations.dataset import write_dataset
from latentarm.tasks.table_top import TableTop
from latentarm.testing.faults import FaultyArm
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup, Spec, load_setup
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.process import ControlProcess
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.channel import Channel
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import AskedGripper, Enable, Given, Order, Paced
from latentarm.web.protocol.report import Report
from latentarm.web.server.app import build_app, gated, serve_on, server_config
from latentarm.web.server.config import TeleopConfig, listen
from latentarm.web.server.connections import ConnectionLimits

HERE = Path(__file__).parent

DRIVE_IN_REAL_TIME = {"site", "serve", "recorded"}
"""Fixtures whose arm tests drive: its control process stops it where the computer keeps it waiting."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents and DRIVE_IN_REAL_TIME & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.clock)


def wait_for(what: Callable[[], Any], within_s: float = 300.0) -> Any:
    """What there is once there is something."""
    end_s = time.monotonic() + within_s
    while not (found := what()):
        assert time.monotonic() < end_s
        time.sleep(0.02)
    return found


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run for the table: principal components of a few demonstrations."""
    from latentarm.runs.options import TrainOptions
    from latentarm.runs.training import train_run

    folder = tmp_path_factory.mktemp("trained")
    write_dataset(TableTop().demonstrate(12, np.random.default_rng(0)), folder / "table")
    train_run(TrainOptions((folder / "table",), "pca", out=folder / "run", seeds=1))
    return folder / "run"


@pytest.fixture(scope="session")
def setup(trained: Path) -> DriveSetup:
    return load_setup(Spec(trained))


def said(told: Any) -> str:
    """What a report, or a state as a page receives it, tells people, in English."""
    state = told.model_dump() if isinstance(told, Report) else told
    return " ".join(Notice(**one).text for one in (state["note"], state["reason"]) if one is not None)


class Watched(Clock):
    """A simulated clock that says when time has passed."""

    def __init__(self, passed: Callable[[float], None]) -> None:
        self._clock = SimulatedClock()
        self._passed = passed

    def now_s(self) -> float:
        return self._clock.now_s()

    def wait_until(self, time_s: float) -> None:
        if time_s > self.now_s():
            self._clock.wait_until(time_s)
            self._passed(time_s)


class Desk:
    """A drive in this process, in simulated time: both ends of the channel are here.

    `each_tick` is called before every tick with the time, s.
    """

    def __init__(
        self,
        setup: DriveSetup,
        folder: Path,
        sightings: Connection | None = None,
        make: Callable[..., Arm] = make_arm,
    ) -> None:
        self.setup = setup
        self.clock = Watched(self._passed)
        reading, self.orders = Pipe(duplex=False)
        self.channel = Channel(reading, sightings)
        self.orphaned = False
        self.writer = EpisodeWriter(folder)
        plant = make(setup.arm, setup.task.robot, setup.start, self.clock.now_s)
        self.arm = FaultyArm(plant, self.clock.now_s)
        self.arm.connect()
        self.drive = Drive(
            setup,
            self.arm,
            self.channel,
            self.clock,
            self.writer,
            lambda: self.orphaned,
            Steering(setup.modes[0]),
            observers=[self._saw],
        )
        self.each_tick: Callable[[float], None] = lambda now_s: None
        self.records: list[Any] = []
        self.reports: list[Report] = []
        self.sequence = 0

    def run(self, for_s: float) -> None:
        """So much time; afterwards the loop has ended and the arm is at rest."""
        self.drive.run(round(for_s / PERIOD_S))

    def give(
        self,
        *u: float,
        nonce: str | None = None,
        latched: bool = False,
        driver: int = 1,
        device: int = 0,
        gripper: GripperAsk | None = None,
        paced: Paced | None = None,
    ) -> None:
        self.sequence += 1
        known = nonce or (self.reports[-1].nonce if self.reports else "")
        given = Given(
            driver=driver,
            seq=self.sequence,
            nonce=known,
            u=u,
            latched=latched,
            source="keyboard",
            device=device,
            gripper=gripper and AskedGripper(ask=gripper, seq=self.sequence, nonce=known),
            paced=paced,
        )
        self.channel.given.write(given.model_dump_json().encode())

    def push(self, for_s: float) -> None:
        """Enable the arm after 0.1 s, and push both axes fully from 0.3 s on."""

        def tick(now_s: float) -> None:
            if abs(now_s - 0.1) < 0.005:
                self.order(Enable(driver=1, stops=self.channel.stop.version))
            self.give(*((1.0, 1.0) if now_s > 0.3 else (0.0, 0.0)))

        self.each_tick = tick
        self.run(for_s)

    def order(self, order: Order) -> None:
        self.orders.send_bytes(order.model_dump_json().encode())

    def speeds(self) -> np.ndarray:
        """(T,), the fastest joint of every command, rad/s."""
        return np.array([np.abs(record.command.velocity).max() for record in self.records])

    def times(self) -> np.ndarray:
        return np.array([record.time_s for record in self.records])

    def _passed(self, now_s: float) -> None:
        self.each_tick(now_s)

    def _saw(self, record: Any) -> None:
        self.records.append(record)
        found = self.channel.report.read()
        report = None if found is None else Report.parse(found[1])
        if report is not None and (not self.reports or report.tick != self.reports[-1].tick):
            self.reports.append(report)


@contextmanager
def a_desk(
    setup: DriveSetup,
    folder: Path,
    sightings: Connection | None = None,
    make: Callable[..., Arm] = make_arm,
) -> Iterator[Desk]:
    desk = Desk(setup, folder, sightings, make)
    yield desk
    desk.writer.close()
    desk.orders.close()
    desk.channel.orders.close()


@pytest.fixture
def desk(setup: DriveSetup, tmp_path: Path) -> Iterator[Desk]:
    with a_desk(setup, tmp_path / "teleop") as desk:
        yield desk


@pytest.fixture
def desk_of(tmp_path: Path) -> Callable[..., AbstractContextManager[Desk]]:
    """A desk for another setup, with sightings of things, and an arm that is made in another way."""
    return lambda setup, *given, **named: a_desk(setup, tmp_path / "teleop", *given, **named)


@pytest.fixture
def desk_in_physics(setup: DriveSetup, tmp_path: Path) -> Iterator[Desk]:
    with a_desk(replace(setup, spec=replace(setup.spec, arm="mujoco")), tmp_path / "teleop") as desk:
        yield desk


def way_m(before: dict[str, Any], after: dict[str, Any]) -> float:
    """How far the tool is from where it was, m."""
    return float(np.linalg.norm(np.subtract(before["tool"], after["tool"])))


@dataclass
class Client:
    """A page without a browser: it keeps the newest state, counts them, and sends inputs while `u` is set."""

    socket: ClientConnection
    state: dict[str, Any] = field(default_factory=dict)
    heard: int = 0
    welcome: dict[str, Any] = field(default_factory=dict)
    learning: dict[str, Any] = field(default_factory=dict)
    poses: list[str] = field(default_factory=list)
    refused: str | None = None
    closed: int | None = None
    u: list[float] | None = None
    latched: bool = False
    sequence: int = 0

    def send(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))

    def wait(self, until: Callable[[dict[str, Any]], Any], within_s: float = 5.0) -> dict[str, Any]:
        """The first state from now on of which something holds."""
        end_s = time.monotonic() + within_s
        while time.monotonic() < end_s:
            if self.state and until(self.state):
                return self.state
            time.sleep(0.005)
        raise AssertionError(f"it never came to that: {self.state}")

    def confirm(self, **changes: Any) -> None:
        """Confirm the checklist of a real arm."""
        points = {"arm_start": self.state["arm_start"], "stop": True, "area": True, "payload": True}
        self.send(type="confirm", **(points | changes))

    def enable(self) -> None:
        """Let go, confirm what there is to confirm and press Enable; on a busy machine more than once."""
        self.u = [0.0] * 2
        if self.welcome["real"]:
            self.confirm()
        for _ in range(5):
            time.sleep(0.06)
            self.send(type="enable")
            with suppress(AssertionError):
                self.wait(lambda state: state["phase"] == "ready", within_s=1.0)
                return
        raise AssertionError(f"it could not be enabled: {self.state}")

    def drive(self, *u: float) -> None:
        """Enable, and push until the arm is on its way: a busy machine may stop it first, and again."""
        for _ in range(5):
            self.enable()
            before = self.state
            self.u = list(u)
            self.wait(
                lambda state, before=before: state["phase"] != "ready" and state["tick"] > before["tick"] + 5
            )
            self.wait(lambda state, before=before: way_m(before, state) > 0.01 or state["phase"] != "moving")
            if self.state["phase"] == "moving":
                return
        raise AssertionError(f"it was stopped five times: {self.state}")

    def wait_closed(self, within_s: float = 5.0) -> None:
        end_s = time.monotonic() + within_s
        while self.closed is None and time.monotonic() < end_s:
            time.sleep(0.005)
        assert self.closed is not None

    def listen(self) -> None:
        with suppress(ConnectionClosed):
            for frame in self.socket:
                message = json.loads(frame)
                if message["type"] == "state":
                    if message["ghosts"] is None:
                        message["ghosts"] = self.state.get("ghosts")
                    self.state = message
                    self.heard += 1
                elif message["type"] == "welcome":
                    self.welcome = message
                elif message["type"] == "learning":
                    self.learning = message
                elif message["type"] == "poses":
                    self.poses = message["names"]
                else:
                    self.refused = message["notice"]["code"]
        self.closed = self.socket.close_code

    def talk(self) -> None:
        with suppress(ConnectionClosed):
            while self.closed is None:
                if self.u is not None and self.state:
                    self.sequence += 1
                    self.send(
                        type="input",
                        seq=self.sequence,
                        nonce=self.state["nonce"],
                        u=self.u,
                        source="pointer",
                        latched=self.latched,
                    )
                time.sleep(0.02)


@dataclass
class Site:
    """A server in a thread of this process, its control process, and pages that connect to it."""

    port: int
    control: ControlProcess
    loop: asyncio.AbstractEventLoop

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def address(self) -> str:
        return f"ws://127.0.0.1:{self.port}/drive"

    @contextmanager
    def raw(self, **changes: Any) -> Iterator[ClientConnection]:
        """A bare socket."""
        options = {"origin": self.origin, "compression": None, "ping_interval": None, **changes}
        with connect(self.address, **options) as socket:
            yield socket

    @contextmanager
    def page(self, name: str = "Ada", **hello: str) -> Iterator[Client]:
        with self.raw() as socket:
            client = Client(socket)
            threads = [threading.Thread(target=work, daemon=True) for work in (client.listen, client.talk)]
            for thread in threads:
                thread.start()
            client.send(type="hello", version=1, name=name, **hello)
            client.wait(lambda state: True, within_s=60.0)  # the control process has begun by then
            try:
                yield client
            finally:
                client.u = None
                socket.close()
                for thread in threads:
                    thread.join()
        self._settled()

    def _settled(self) -> None:
        """Whoever comes next finds the arm at rest and nobody who drives."""
        time.sleep(0.1)


@contextmanager
def served(spec: Spec, *, pins: bool = False, locked: bool = False) -> Iterator[Site]:
    config = TeleopConfig(spec, port=0, pins=pins, lock_setup=locked)
    listening = listen(config)
    port = int(listening.getsockname()[1])
    control = ControlProcess(spec)
    app = build_app(load_setup(spec), control, config)
    server = uvicorn.Server(server_config(gated(app, control, config, port, None, lambda: ""), config))
    loops: list[asyncio.AbstractEventLoop] = []

    async def run() -> None:
        loops.append(asyncio.get_running_loop())
        await serve_on(listening, server, ConnectionLimits())

    thread = threading.Thread(target=lambda: asyncio.run(run()), daemon=True)
    with ExitStack() as stack:
        stack.callback(listening.close)
        stack.callback(control.end)
        thread.start()
        stack.callback(thread.join, 10.0)
        stack.callback(setattr, server, "should_exit", True)
        while not server.started:
            time.sleep(0.01)
        yield Site(port, control, loops[0])


@pytest.fixture(scope="session")
def serve() -> Callable[..., AbstractContextManager[Site]]:
    """A server of its own for a test that changes what is driven."""
    return served


@pytest.fixture(scope="session")
def site(trained: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    with served(Spec(trained, out=tmp_path_factory.mktemp("teleop"))) as site:
        yield site
