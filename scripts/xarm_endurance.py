"""How the xArm's driver bears minutes of driving, and how the arm comes to rest when something breaks.

No arm is needed: the manufacturer's library talks to `tests/arms/xarm_server.py`, a stand-in for the
controller in a process of its own. A second process drives it with the control loop at 100 Hz, the stick
going round in a circle. A third kills it, cuts the network, loses the input, restarts the controller, and
presses the emergency stop.

Times count from the fault and are the stand-in's own. A second later the fault is repaired, and the stick
stays pushed for another half second: the arm must not move before the person lets go and enables it.

    chrt -r 10 python scripts/xarm_endurance.py --minutes 10 --tries 50
"""

import argparse
import json
import math
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final

import numpy as np

from latentarm.arms.address import parse_address
from latentarm.arms.xarm.arm import XArm
from latentarm.arms.xarm.sdk import load_sdk
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import MonotonicClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.punctuality import ask_for_priority, short_collections
from latentarm.core.types import Input, StepRecord
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from arms.xarm_rig import xarm7
from arms.xarm_server import XArmServer, serving

PERIOD_S: Final = 0.01
JOINT_SPEED: Final = 0.4
ROUND_S: Final = 4.0
GRIPPER_S: Final = 3.0
BROKEN_S: Final = 1.0
WAITING_S: Final = 0.5

FAULTS: Final[dict[str, str]] = {
    "killed": "driver killed (SIGKILL)",
    "cut": "network cut for 1 s",
    "input": "input lost",
    "restart": "controller restarted",
    "press": "emergency stop pressed",
}


class Hand(InputSource):
    """Goes round in a circle while it pushes, and toggles the gripper now and then.

    Attributes:
        pushes: whether it does.
        lost_s: since when nothing is heard of it, s; infinity while it is.
        toggles: how often it has asked the gripper to toggle.
    """

    def __init__(self) -> None:
        self.pushes = False
        self.lost_s = math.inf
        self.toggles = 0
        self._next_s = time.monotonic() + GRIPPER_S

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        angle = 2.0 * math.pi * now_s / ROUND_S
        u = np.array([math.cos(angle), math.sin(angle)]) if self.pushes else np.zeros(2)
        asked = None
        if self.pushes and now_s >= self._next_s:
            self._next_s, asked = now_s + GRIPPER_S, "toggle"
            self.toggles += 1
        return Input(u, gripper=asked), max(0.0, now_s - self.lost_s)


def drive(address: str, robot: Robot, orders: Connection) -> None:
    """Drive until told to finish: what the second process does."""
    ask_for_priority()
    clock, hand = MonotonicClock(), Hand()
    arm = XArm(robot, parse_address(address), clock.now_s)
    arm.connect()
    step = Step(robot, EndEffectorController(robot), SafetyConfig(joint_speed=JOINT_SPEED), dt_s=PERIOD_S)
    stops: list[tuple[float, str]] = []
    armed = ending = False

    def observe(record: StepRecord) -> None:
        nonlocal armed
        if armed and record.command.stop is not None and not ending:
            stops.append((round(clock.now_s(), 2), record.command.stop.reason))
        armed = record.command.stop is None

    loop = ControlLoop(step, arm, hand, clock, [observe])

    def obey() -> None:
        nonlocal ending
        while True:
            order = orders.recv()
            match order:
                case "enable":
                    loop.enable()
                case "push" | "let go":
                    hand.pushes = order == "push"
                case "lose":
                    hand.lost_s = time.monotonic()
                case "find":
                    hand.lost_s = math.inf
                case "finish":
                    ending = True
                    loop.finish()
                    return
            stop = step.stopped
            orders.send((stop is None, arm.status().phase, "" if stop is None else stop.reason))

    threading.Thread(target=obey, daemon=True).start()
    with short_collections():
        figures = loop.run()
    arm.close()
    orders.send(
        {
            "ticks": figures.ticks,
            "deadlines_met": figures.met_share,
            "worst_start_ms": 1000.0 * figures.worst_start_s,
            "toggles": hand.toggles,
            "stops": stops,
        }
    )


class Driver:
    """The second process, as the third sees it."""

    def __init__(self, address: str, robot: Robot) -> None:
        context = multiprocessing.get_context("fork")
        self._orders, theirs = context.Pipe()
        self._process = context.Process(target=drive, args=(address, robot, theirs), daemon=True)
        self._process.start()
        theirs.close()

    def tell(self, order: str) -> Any:
        """Give an order; (whether it is armed, the arm's phase, why not)."""
        self._orders.send(order)
        if not self._orders.poll(30.0):
            raise RuntimeError("the driving process does not answer")
        return self._orders.recv()

    def arm(self) -> str:
        """Let go, enable, and wait; what was said before, one sentence."""
        said = self.tell("let go")[2]
        for _ in range(20):
            self.tell("enable")
            for _ in range(20):
                time.sleep(0.05)
                armed, phase, _ = self.tell("let go")
                if armed and phase in ("ready", "moving"):
                    return str(said)
        raise RuntimeError(f"the arm cannot be enabled: {self.tell('let go')}")

    def finish(self) -> dict[str, Any]:
        """End the drive; its figures."""
        self._orders.send("finish")
        return dict(self._orders.recv())

    def kill(self) -> None:
        """End it at once."""
        if self._process.pid is not None:
            os.kill(self._process.pid, signal.SIGKILL)
        self._process.join()


@dataclass(frozen=True)
class Try:
    """One fault.

    Attributes:
        rest_ms: from the fault until every joint stands still for good.
        travel_mm: how far the tool went meanwhile.
        jump_mm: the farthest that the tool was from where it had come to rest, until the person pushed again.
        moves_again: whether it moved then.
        said: what the person read.
    """

    rest_ms: float
    travel_mm: float
    jump_mm: float
    moves_again: bool
    said: str


def try_fault(
    server: XArmServer, robot: Robot, fault: str, rng: np.random.Generator, driver: Driver
) -> tuple[Try, Driver]:
    """Let one fault happen in motion."""
    driver.arm()
    driver.tell("push")
    time.sleep(float(rng.uniform(0.8, 1.8)))
    if fault == "killed":
        since_s = time.monotonic()
        driver.kill()
        said = "(killed)"
    elif fault == "input":
        since_s = time.monotonic()
        driver.tell("lose")
    else:
        since_s = server.do(fault)
    time.sleep(BROKEN_S)
    repaired_s = time.monotonic()
    if fault == "killed":
        driver = Driver(server.address(), robot)
    elif fault == "cut":
        server.do("reconnect")
    elif fault == "press":
        server.do("release")
    elif fault == "input":
        driver.tell("find")
    time.sleep(WAITING_S)
    if fault == "killed":
        driver.arm()
    else:
        said = driver.arm()
    time.sleep(0.2)
    pushed_s = time.monotonic()
    driver.tell("push")
    time.sleep(0.6)
    trace = server.do("trace", since_s=since_s)
    times = np.array([row[0] for row in trace])
    fastest = np.array([row[2] for row in trace])
    tool = robot.chain.forward(np.array([row[1] for row in trace])).position
    moving = np.flatnonzero((fastest > STILL_RAD_S) & (times < repaired_s))
    rests = int(moving[-1]) + 1 if len(moving) else 0
    resting = (times >= times[rests]) & (times < pushed_s)
    return (
        Try(
            1000.0 * float(times[rests] - since_s),
            1000.0 * float(np.linalg.norm(tool[rests] - tool[0])),
            1000.0 * float(np.linalg.norm(tool[resting] - tool[rests], axis=1).max()),
            bool(fastest[times > pushed_s].max() > STILL_RAD_S),
            said,
        ),
        driver,
    )


def endure(robot: Robot, minutes: float) -> dict[str, Any]:
    """Drive for minutes, enabling again after each stop."""
    with serving(q=robot.home.tolist()) as server:
        driver = Driver(server.address(), robot)
        driver.arm()
        driver.tell("push")
        until_s = time.monotonic() + 60.0 * minutes
        widths: list[float] = []
        while time.monotonic() < until_s:
            time.sleep(0.5)
            widths.append(server.do("state")["gripper"])
            if not driver.tell("push")[0]:
                driver.arm()
                driver.tell("push")
        driver.tell("let go")
        sent = server.do("state")["commands"]
        figures = driver.finish()
    return {
        **figures,
        "minutes": minutes,
        "commands_received": sent,
        "gripper_units_seen": [min(widths), max(widths)],
        "aborts": len(figures["stops"]),
    }


def tabulate(tries: dict[str, list[Try]]) -> str:
    """A table in Markdown."""
    lines = [
        "| what happens | tries | rest after, ms (median / worst) | tool's way meanwhile, mm (worst) |"
        " largest jump until pushed again, mm | moved again after enabling |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for fault, found in tries.items():
        rest = [one.rest_ms for one in found]
        lines.append(
            f"| {FAULTS[fault]} | {len(found)} | {np.median(rest):.0f} / {max(rest):.0f} |"
            f" {max(one.travel_mm for one in found):.1f} | {max(one.jump_mm for one in found):.3f} |"
            f" {sum(one.moves_again for one in found)} of {len(found)} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10.0, help="of endurance")
    parser.add_argument("--tries", type=int, default=50, help="of each fault")
    parser.add_argument("--faults", nargs="*", default=list(FAULTS), choices=list(FAULTS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="where every try is written")
    given = parser.parse_args()
    robot = xarm7()
    load_sdk()  # before the first fork
    say: Callable[[str], object] = lambda text: (sys.stdout.write(text + "\n"), sys.stdout.flush())  # noqa: E731
    tries: dict[str, list[Try]] = {}
    for fault in given.faults if given.tries else []:
        rng = np.random.default_rng([given.seed, list(FAULTS).index(fault)])
        with serving(q=robot.home.tolist()) as server:
            driver = Driver(server.address(), robot)
            tries[fault] = []
            for _ in range(given.tries):
                one, driver = try_fault(server, robot, fault, rng, driver)
                tries[fault].append(one)
            driver.kill()
        say(f"{fault}: {dict(Counter(one.said for one in tries[fault]))}")
    say(tabulate(tries))
    endurance = endure(robot, given.minutes) if given.minutes else {}
    say(json.dumps(endurance, indent=2))
    if given.json:
        document = {"tries": {name: [vars(one) for one in found] for name, found in tries.items()}}
        given.json.write_text(json.dumps({**document, "endurance": endurance}, indent=1))


if __name__ == "__main__":
    main()
