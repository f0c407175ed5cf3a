"""Drive the arm behind ROS 2 for minutes, break everything about it many times, and say when it was at rest.

    python scripts/ros2_endurance.py --out runs/ros2 [--kind trajectory] [--minutes 5] [--tries 50] [--seed 0]

The arm is simulated: `tests/stand_ins/rosbridge_server.py` speaks the rosbridge protocol in a process of its
own, with the published watchdog next to a simulated arm. The driver, the control loop at 100 Hz and the
safety filters run in another process, with a scripted stick. Rest and motion are taken from the simulated arm
itself, on its own clock. Writes ``endurance.json`` and ``endurance.md``.
"""

import json
import multiprocessing
import os
import platform
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final, Literal, final

import numpy as np
import tyro

from latentarm.arms.real_catalogue import make_real_arm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import MonotonicClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.punctuality import ask_for_priority, short_collections
from latentarm.core.types import FloatArray, Input, StepRecord
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig

ROOT: Final = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "stand_ins"))

from rosbridge_server import RosbridgeServer, ServerProcess, Setup  # noqa: E402 - found by the line above

PROCESSES: Final = multiprocessing.get_context("forkserver")
"""What is imported once need not be imported for each of many drivers."""

PERIOD_S: Final = 0.01
BROKEN_S: Final = 0.8
"""What is broken stays broken for so long, s."""

PUSHED_S: Final = 0.4
"""For so long the stick is still pushed afterwards, before anybody enables the arm, s."""

PATIENCE_S: Final = 60.0
"""The arm must be ready so soon after it was enabled, s."""

Fault = Literal[
    "driver killed",
    "network cut",
    "input lost",
    "controller restarted",
    "emergency stop",
    "joint states frozen",
    "clock set",
]
FAULTS: Final[tuple[Fault, ...]] = (
    "driver killed",
    "network cut",
    "input lost",
    "controller restarted",
    "emergency stop",
    "joint states frozen",
    "clock set",
)


@final
@dataclass(frozen=True)
class Options:
    """What is done.

    Attributes:
        out: folder of the results.
        kind: of the controller.
        minutes: of driving without faults.
        tries: of each fault.
        faults: which are tried; all by default.
        seed: of directions and moments.
    """

    out: Path
    kind: Literal["velocity", "trajectory"] = "velocity"
    minutes: float = 5.0
    tries: int = 50
    faults: tuple[Fault, ...] = FAULTS
    seed: int = 0


@final
class Stick(InputSource):
    """Held as it was last told, and lost when it was told so; on its own it goes in circles."""

    def __init__(self) -> None:
        self.given = Input(np.zeros(2))
        self.lost_s = 0.0
        self.circling = False

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        if self.circling:
            turned = 2.0 * np.pi * now_s / 4.0
            asked = "toggle" if now_s % 6.0 < 0.5 else None
            return Input(0.9 * np.array([np.cos(turned), np.sin(turned)]), gripper=asked), 0.0
        return self.given, now_s - self.lost_s if self.lost_s else 0.0


def drive(address: str, robot: Robot, pipe: Connection) -> None:
    """In a process of its own: connect, and do what the other end of the pipe says."""
    ask_for_priority()
    clock, stick = MonotonicClock(), Stick()
    arm = make_real_arm(address, robot, clock.now_s)
    arm.connect()
    newest: list[StepRecord] = []
    aborts: list[tuple[float, str]] = []

    def observe(record: StepRecord) -> None:
        stop = record.command.stop
        if stop is not None and newest and newest[0].command.stop is None:
            aborts.append((clock.now_s(), stop.reason))
        newest[:] = [record]

    step = Step(robot, EndEffectorController(robot), SafetyConfig(), dt_s=PERIOD_S)
    loop = ControlLoop(step, arm, stick, clock, [observe])

    def told() -> tuple[str, Any]:
        try:
            return pipe.recv()
        except EOFError:
            return "finish", None

    def obey() -> None:
        while True:
            what, given = told()
            match what:
                case "push":
                    stick.lost_s, stick.circling, stick.given = 0.0, False, Input(np.array(given))
                case "circle":
                    stick.circling = True
                case "lose":
                    stick.lost_s = clock.now_s()
                case "enable":
                    loop.enable()
                case "state":
                    stop = newest[0].command.stop if newest else None
                    figures = loop.statistics()
                    engaged = bool(newest) and stop is None and arm.status().takes_commands
                    pipe.send((engaged, "" if stop is None else stop.reason, list(aborts), figures))
                case _:
                    loop.finish()
                    return

    threading.Thread(target=obey, daemon=True).start()
    pipe.send("connected")
    with short_collections():
        loop.run()
    arm.close()


class Driver:
    """The process that drives."""

    def __init__(self, address: str, robot: Robot) -> None:
        self.pipe, theirs = PROCESSES.Pipe()
        self._process = PROCESSES.Process(target=drive, args=(address, robot, theirs), daemon=True)
        self._process.start()
        theirs.close()
        if self.pipe.recv() != "connected":
            raise RuntimeError("the driver did not connect")

    def tell(self, what: str, given: object = None) -> None:
        """Say what to do."""
        self.pipe.send((what, given))

    def state(self) -> tuple[bool, str, list[tuple[float, str]], Any]:
        """Whether it drives, why not, when and why it was ever stopped, and how punctual it was."""
        self.tell("state")
        return self.pipe.recv()

    def kill(self) -> None:
        """SIGKILL: it can do nothing any more."""
        self._process.kill()
        self._process.join()

    def end(self) -> None:
        """Bring the arm to rest and end."""
        self.tell("finish")
        self._process.join(15.0)

    def enable(self) -> float:
        """Let go of the stick and enable the arm, as a person does; how long that took, s."""
        self.tell("push", (0.0, 0.0))
        time.sleep(0.1)
        began_s = time.monotonic()
        while True:
            self.tell("enable")
            until_s = time.monotonic() + 6.0
            while time.monotonic() < until_s:
                if self.state()[0]:
                    return time.monotonic() - began_s
                time.sleep(0.02)
            if time.monotonic() - began_s > PATIENCE_S:
                raise RuntimeError(f"the arm was not enabled: {self.state()[1]}")


@final
@dataclass(frozen=True)
class Try:
    """One fault in motion.

    Attributes:
        rest_s: from the fault until the arm stood still, s.
        crept_mm: how far the tool moved from then until the stick was pushed again, mm.
        enabling_s: from the person's enabling until the arm was ready, s.
        moves_again: whether it then moved.
        reason: what the person read.
    """

    rest_s: float
    crept_mm: float
    enabling_s: float
    moves_again: bool
    reason: str


def try_fault(
    fault: Fault, server: ServerProcess, driver: Driver, robot: Robot, rng: np.random.Generator, sign: int
) -> tuple[Try | str, Driver]:
    """Break one thing while the arm moves, repair it, and enable the arm again.

    Returns:
        What came of it, or why the arm did not move when it was to be broken; and who drives now.
    """
    driver.enable()
    angle = rng.uniform(-0.5, 0.5)
    push = sign * np.array([np.cos(angle), np.sin(angle)])
    server.take_trace()
    driver.tell("push", tuple(push))
    time.sleep(rng.uniform(0.4, 0.8))
    engaged, why, _, _ = driver.state()
    fault_s = time.monotonic()
    repair = _break(fault, server, driver)
    time.sleep(BROKEN_S)
    reason = "" if fault == "driver killed" else driver.state()[1]
    repair()
    time.sleep(PUSHED_S)
    if fault == "driver killed":
        driver = Driver(server.address, robot)
    enabling_s = driver.enable()
    time.sleep(0.1)
    times, q = server.take_trace()
    # Back where it came from, so that many tries stay about home.
    driver.tell("push", tuple(-push))
    time.sleep(0.6)
    driver.tell("push", (0.0, 0.0))
    time.sleep(0.3)
    _, again = server.take_trace()
    speeds = np.abs(np.diff(q, axis=0)).max(axis=1) / np.diff(times)
    if not (speeds[times[1:] <= fault_s][-4:] > STILL_RAD_S).any():
        return "the arm was at its limits" if engaged else why, driver
    rested = int(np.flatnonzero(speeds > STILL_RAD_S)[-1]) + 1
    tools = robot.chain.forward(q[rested:]).position
    crept_m = np.linalg.norm(tools - tools[0], axis=1).max()
    moved = np.abs(again - again[0]).max() > 0.01
    return Try(times[rested] - fault_s, 1e3 * float(crept_m), enabling_s, bool(moved), reason), driver


def _break(fault: Fault, server: ServerProcess, driver: Driver) -> Callable[[], object]:
    """Break it; returns what repairs it."""
    match fault:
        case "driver killed":
            driver.kill()
            return lambda: None
        case "network cut":
            server.ask("cut")
            return lambda: server.ask("repair")
        case "input lost":
            driver.tell("lose")
            return lambda: driver.tell("push", (0.5, 0.0))
        case "controller restarted":
            server.ask("restart_controller", 0.3)
            return lambda: None
        case "emergency stop":
            server.ask("press_emergency_stop")
            return lambda: server.ask("release_emergency_stop")
        case "joint states frozen":
            server.ask("set_states", "frozen")
            return lambda: server.ask("set_states", "good")
        case "clock set":
            server.ask("jump_clock", 30.0)
            return lambda: None


def endure(server: ServerProcess, robot: Robot, minutes: float) -> dict[str, Any]:
    """Drive in circles, with the gripper, and count aborts; after each the arm is enabled again."""
    driver = Driver(server.address, robot)
    driver.enable()
    goals = server.ask("goals")
    driver.tell("circle")
    end_s, stopped = time.monotonic() + 60.0 * minutes, 0
    while time.monotonic() < end_s:
        time.sleep(0.5)
        server.take_trace()
        if not driver.state()[0]:
            stopped += 1
            driver.enable()
            driver.tell("circle")
    _, _, aborts, figures = driver.state()
    driver.end()
    return {
        "minutes": minutes,
        "aborts": aborts,
        "commands": figures.ticks,
        "deadlines_met": figures.met_share,
        "late_p99_ms": 1e3 * figures.p99_s,
        "gripper_goals": server.ask("goals") - goals,
        "gripper_aborts": server.ask("aborted"),
        "load": os.getloadavg(),
    }


def refusals(robot: Robot, kind: str) -> Iterator[tuple[str, str, float]]:
    """What each thing that cannot be driven is answered with, and how far the arm moved, rad."""
    usual = Setup(kind=kind)
    cases: dict[str, tuple[Setup, str]] = {
        "no watchdog": (replace(usual, watchdog=False), "good"),
        "watchdog of another version": (replace(usual, version=0), "good"),
        "joint states that repeat one moment": (usual, "repeated"),
        "joint states not numbers": (usual, "nan"),
        "a joint missing": (usual, "missing"),
        "no joint states": (usual, "none"),
        "wrong DoF": (usual, "good"),
        "a second client": (usual, "good"),
    }
    for name, (setup, states) in cases.items():
        with RosbridgeServer(robot, setup) as server:
            server.states_as = states
            yield name, *_refused(name, server, robot)


def _refused(name: str, server: RosbridgeServer, robot: Robot) -> tuple[str, float]:
    before = server.positions()
    first = make_real_arm(server.address, robot, MonotonicClock().now_s)
    if name == "a second client":
        first.connect()
    address, one = server.address, robot
    if name == "wrong DoF":
        address, one = address.partition("&gripper")[0], planar(5)
    said = "it was not refused"
    try:
        make_real_arm(address, one, MonotonicClock().now_s).connect()
    except UserError as error:
        said = str(error)
    first.close()
    return said, float(np.abs(server.positions() - before).max())


@contextmanager
def progress(text: str) -> Iterator[None]:
    """Say what is being done, and how long it took."""
    began_s = time.monotonic()
    yield
    print(f"{text}: {time.monotonic() - began_s:.0f} s", flush=True)


def main(options: Options) -> None:
    """Do all of it, and write the tables."""
    PROCESSES.set_forkserver_preload(["__main__", "roslibpy.comm.comm_asyncio"])
    robot, rng = panda(), np.random.default_rng(options.seed)
    options.out.mkdir(parents=True, exist_ok=True)
    found: dict[str, Any] = {"kind": options.kind, "tries": options.tries, "seed": options.seed}
    found["machine"] = f"{os.cpu_count()} cores, {platform.machine()}"
    with ServerProcess(robot, Setup(kind=options.kind)) as server:
        with progress("endurance"):
            found["endurance"] = endure(server, robot, options.minutes)
        (options.out / "endurance.json").write_text(json.dumps(found, indent=1))
        driver = Driver(server.address, robot)
        found["faults"], found["spoiled"] = {}, []
        for fault in options.faults:
            with progress(fault):
                tries: list[Try] = []
                sign = 1
                while len(tries) < options.tries and len(found["spoiled"]) < options.tries:
                    sign = -sign
                    one, driver = try_fault(fault, server, driver, robot, rng, sign)
                    if isinstance(one, Try):
                        tries.append(one)
                        found["faults"][fault] = [vars(one) for one in tries]
                    else:
                        found["spoiled"].append(f"{fault}: {one}")
            (options.out / "endurance.json").write_text(json.dumps(found, indent=1))
        driver.end()
    with progress("refusals"):
        found["refusals"] = [list(one) for one in refusals(robot, options.kind)]
    (options.out / "endurance.json").write_text(json.dumps(found, indent=1))
    (options.out / "endurance.md").write_text(table(found))
    print(table(found))


def table(found: dict[str, Any]) -> str:
    """The results in Markdown."""
    ran = found["endurance"]
    lines = [
        f"{ran['minutes']:g} minutes at 100 Hz ({ran['commands']} commands): {len(ran['aborts'])} aborts;"
        f" {100 * ran['deadlines_met']:.1f} % of deadlines met, p99 {ran['late_p99_ms']:.1f} ms;"
        f" {ran['gripper_goals']} gripper goals, {ran['gripper_aborts']} aborted."
        f" Load average {ran['load'][0]:.1f} on {found['machine']}.",
        *(f"- aborted at {at_s:.2f} s of the monotonic clock: {reason}" for at_s, reason in ran["aborts"]),
        "",
        "| what happens | n | at rest after, ms: mean (SD) | worst | largest creep of the tool, mm |"
        " moves again only when enabled | enabling, s: median, worst |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    for fault, tries in found["faults"].items():
        rest = 1e3 * np.array([one["rest_s"] for one in tries])
        enabling: FloatArray = np.array([one["enabling_s"] for one in tries])
        again = sum(one["moves_again"] and one["crept_mm"] < 0.5 for one in tries)
        lines.append(
            f"| {fault} | {len(tries)} | {rest.mean():.0f} ({rest.std(ddof=1):.0f}) | {rest.max():.0f} |"
            f" {max(one['crept_mm'] for one in tries):.2g} | {again} of {len(tries)} |"
            f" {np.median(enabling):.1f}, {enabling.max():.1f} |"
        )
    lines += ["", *(f"- spoiled before it was broken: {one}" for one in found["spoiled"])]
    lines += ["", "| what is wrong | what is said | motion, rad |", "|---|---|--:|"]
    lines += [f"| {name} | {said} | {moved:.1g} |" for name, said, moved in found["refusals"]]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main(tyro.cli(Options))
