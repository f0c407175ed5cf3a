"""How long a simulated Franka is driven without an abort, and how it stops when something breaks.

franky-sim (see `tests/stand_ins/franka_server.py`) is driven through the control loop at 100 Hz by a stick
that changes at random, with the hand. Loop and driver go by the arm's own clock, because the simulator can be
slower than real time on a busy machine. Then, for each fault and try, the arm is driven and the fault is
made. What is measured is the arm's own, in each of its cycles of 1 ms:

    python scripts/franka_endurance.py --minutes 10 --tries 50

The network is cut in the stand-in, which then stops after 20 cycles without a message, as the arm does.
"""

import argparse
import json
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final, final

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "stand_ins"))

from franka_server import FrankaStandIn

from latentarm.arms.real_catalogue import make_real_arm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import Clock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.punctuality import ask_for_priority, short_collections
from latentarm.core.types import FloatArray, Input, StepRecord
from latentarm.robots.panda import fr3
from latentarm.safety.config import SafetyConfig

HOST: Final = "127.0.9.1"
ADDRESS: Final = f"franka://{HOST}?realtime=ignore"
FAULTS: Final = ("driver killed", "network cut", "input lost", "controller restarted", "stop button")
DRIVE_S: Final = 0.8
QUIET_S: Final = 0.4
"""How long the arm must stay where it is before the person enables it again, s of its clock."""

MOVES_WITHIN_S: Final = 5.0
"""The stick has pushed ten ways by then, s of the arm's clock."""

REST_RAD_S: Final = 0.005

COUNTED: Final = ("moved_before_enabling", "moves_when_enabled")
"""Figures of a try that are 1 where it happened, and 0 where not."""

_WALL_S: Final = 60.0


@final
class ArmClock(Clock):
    """The clock of the stand-in.

    Args:
        path: where the stand-in counts its cycles.
    """

    def __init__(self, path: Path) -> None:
        self._cycles = np.memmap(path, np.int64, "r", shape=(1,))

    def now_s(self) -> float:
        """See the base class."""
        return 1e-3 * float(self._cycles[0])

    def wait_until(self, time_s: float) -> None:
        """See the base class."""
        while self.now_s() < time_s:
            time.sleep(2e-4)


@final
class Stick(InputSource):
    """A stick that changes twice a second, a mode switch now and then, and the hand.

    Args:
        seed: of its moves.
    """

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._until_s = self.neutral_until_s = 0.0
        self._u: FloatArray = np.zeros(2)
        self._switch = False
        self._grip = False
        self.lost_at_s = np.inf

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        if now_s >= self._until_s:
            self._until_s = now_s + 0.5
            self._u = self._rng.uniform(-1.0, 1.0, 2)
            self._switch = self._rng.random() < 0.3
            self._grip = self._rng.random() < 0.15
        if now_s < self.neutral_until_s:
            return Input(np.zeros(2)), 0.0
        given = Input(self._u, self._switch, "toggle" if self._grip else None)
        return given, max(0.0, now_s - self.lost_at_s)


@final
@dataclass
class Seen:
    """What happened in one process that drives.

    Attributes:
        ticks: of the loop.
        moving: ticks in which the arm was sent a motion.
        stops: when the arm was stopped, s of the monotonic clock, and why.
        widths: least and largest opening of the hand, m.
    """

    ticks: int = 0
    moving: int = 0
    stops: list[tuple[float, str]] = field(default_factory=list)
    widths: list[float] = field(default_factory=lambda: [1.0, 0.0])

    def see(self, record: StepRecord) -> None:
        """Take a record of the loop."""
        self.ticks += 1
        self.moving += bool(record.command.velocity.any())
        if record.gripper is not None:
            width = record.gripper.width_m
            self.widths = [min(self.widths[0], width), max(self.widths[1], width)]


def drive(clock_path: str, seed: int, told: Connection) -> None:
    """Drive in a process of its own, and do what is told."""
    ask_for_priority()
    clock = ArmClock(Path(clock_path))
    robot, stick, seen = fr3(), Stick(seed), Seen()
    step = Step(robot, EndEffectorController(robot), SafetyConfig(), dt_s=0.01)
    arm = make_real_arm(ADDRESS, robot, clock.now_s)
    arm.connect()
    last: list[str] = [""]

    def observe(record: StepRecord) -> None:
        seen.see(record)
        stopped = step.stopped
        why = "" if stopped is None else stopped.reason
        if why and not last[0]:
            seen.stops.append((round(time.monotonic(), 2), why))
        last[0] = why

    loop = ControlLoop(step, arm, stick, clock, [observe])
    threading.Thread(target=loop.run, daemon=True).start()
    with short_collections():
        while True:
            match told.recv():
                case "enable":
                    stick.lost_at_s = np.inf
                    stick.neutral_until_s = clock.now_s() + 0.3
                    clock.wait_until(clock.now_s() + 0.1)
                    loop.enable()
                    told.send(True)
                case "lose input":
                    stick.lost_at_s = clock.now_s()
                    told.send(True)
                case "report":
                    late = loop.statistics()
                    told.send((seen, last[0], step.stopped is None, str(arm.status()), late.met_share))
                case _:
                    loop.finish()
                    arm.close()
                    told.send(True)
                    return


@final
class Driver:
    """The process that drives, from the outside."""

    def __init__(self, clock_path: Path, seed: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._here, there = context.Pipe()
        self.process = context.Process(target=drive, args=(str(clock_path), seed, there), daemon=True)
        self.process.start()

    def ask(self, order: str) -> Any:
        """Give an order, and wait for the answer."""
        self._here.send(order)
        if not self._here.poll(_WALL_S):
            raise RuntimeError(f"no answer to {order}")
        return self._here.recv()

    def enable(self) -> None:
        """The person enables the arm, again until it takes commands."""
        end_s = time.monotonic() + _WALL_S
        while not self.engaged():
            self.ask("enable")
            wait_s = time.monotonic() + 3.0
            while not self.engaged() and time.monotonic() < wait_s:
                time.sleep(0.05)
            if time.monotonic() > end_s:
                raise RuntimeError(f"the arm was not enabled: {self.ask('report')}")

    def report(self) -> tuple[Seen, str, bool, str, float]:
        """What was seen, why the arm is stopped, whether it may move, its status, and the deadlines met."""
        return self.ask("report")

    def engaged(self) -> bool:
        """Whether the arm may move."""
        return self.report()[2]

    def end(self) -> None:
        """End it, one way or the other."""
        if self.process.is_alive():
            self.ask("end")
            self.process.join(5.0)
        self.process.kill()


def endure(clock: ArmClock, clock_path: Path, minutes: float, seed: int) -> dict[str, object]:
    """Drive for so long by the arm's clock, and count what stops the arm."""
    driver = Driver(clock_path, seed)
    driver.enable()
    began_s, wall_s, enabled_again = clock.now_s(), time.monotonic(), 0
    end_s = began_s + 60.0 * minutes
    while clock.now_s() < end_s:
        clock.wait_until(min(clock.now_s() + 1.0, end_s))
        if not driver.engaged():
            driver.enable()
            enabled_again += 1
    seen, _, _, _, met = driver.report()
    driver.end()
    return {
        "arm_s": clock.now_s() - began_s,
        "wall_s": time.monotonic() - wall_s,
        "ticks": seen.ticks,
        "moving_ticks": seen.moving,
        "stops": seen.stops,
        "enabled_again": enabled_again,
        "hand_mm": [1e3 * width for width in seen.widths],
        "deadlines_met": met,
    }


def fault_try(
    fault: str, stand_in: FrankaStandIn, clock: ArmClock, driver: Driver, log: Path
) -> tuple[dict[str, float], Driver]:
    """Make one fault; the driver that goes on is a new one where the old was killed."""
    driver.enable()
    clock.wait_until(clock.now_s() + DRIVE_S)
    stand_in.ask("log")
    clock.wait_until(clock.now_s() + 0.1)
    at_s = _break(fault, stand_in, driver)
    if fault != "controller restarted":
        stand_in.wait(QUIET_S)
    _mend(fault, stand_in)
    if fault == "controller restarted":
        stand_in.ask("log")
        at_s = 0.0
    # Time alone, and what the driver goes on to send, move nothing.
    stand_in.wait(QUIET_S)
    stand_in.ask(f"save {log}")
    found = measured(np.load(log), at_s)
    if fault == "driver killed":
        driver = Driver(clock_path=Path(str(log) + ".clock"), seed=int(1e3 * at_s))
    before = stand_in.positions()
    driver.enable()
    found["moves_when_enabled"] = float(moves(stand_in, clock, before))
    return found, driver


def measured(rows: FloatArray, at_s: float) -> dict[str, float]:
    """How the arm came to rest.

    Args:
        rows: (n, 18), of the stand-in's log: time (s), joints (rad), their velocities (rad/s), tool (m).
        at_s: when the fault was made, on the arm's clock, s; 0 where the arm has lost its power.

    Returns:
        The figures.
    """
    t, dq, tool = rows[:, 0], rows[:, 8:15], rows[:, 15:18]
    moving = np.flatnonzero((np.abs(dq) > REST_RAD_S).any(axis=1) & (t >= at_s))
    rest_s = float(t[moving[-1]] - at_s) if len(moving) else 0.0
    steps = np.linalg.norm(np.diff(tool[t >= at_s], axis=0), axis=1)
    return {
        "rest_ms": 1e3 * rest_s,
        "jump_mm": 1e3 * float(steps.max()) if len(steps) else 0.0,
        "moved_before_enabling": float(rest_s > QUIET_S),
        "speed_rad_s": float(np.abs(dq[np.searchsorted(t, at_s) - 1]).max()) if at_s else 0.0,
    }


def moves(stand_in: FrankaStandIn, clock: ArmClock, before: FloatArray) -> bool:
    """Whether the arm goes anywhere; not at once where the stick happens to push against a limit."""
    end_s = clock.now_s() + MOVES_WITHIN_S
    while clock.now_s() < end_s:
        clock.wait_until(clock.now_s() + 0.1)
        if (np.abs(stand_in.positions() - before) > 1e-3).any():
            return True
    return False


def _break(fault: str, stand_in: FrankaStandIn, driver: Driver) -> float:
    """Make a fault.

    Returns:
        When, on the arm's clock, s.
    """
    match fault:
        case "driver killed":
            at_s = stand_in.time_s()
            os.kill(driver.process.pid or 0, signal.SIGKILL)
        case "network cut":
            at_s = stand_in.ask("cut")["t"]
        case "input lost":
            at_s = stand_in.time_s()
            driver.ask("lose input")
        case "controller restarted":
            at_s = stand_in.time_s()
            stand_in.kill()
        case _:
            at_s = stand_in.ask("press")["t"]
    return at_s


def _mend(fault: str, stand_in: FrankaStandIn) -> None:
    if fault == "network cut":
        stand_in.repair()
    elif fault == "controller restarted":
        stand_in.start()
    elif fault == "stop button":
        stand_in.release_emergency_stop()


def main() -> None:
    """Run it, and print a table as JSON."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--tries", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--faults", nargs="*", default=FAULTS, choices=FAULTS)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.npy"
        clock_path = Path(str(log) + ".clock")
        np.zeros(1, np.int64).tofile(clock_path)
        with FrankaStandIn(HOST, clock_file=clock_path) as stand_in:
            clock = ArmClock(clock_path)
            if options.minutes:
                print(json.dumps(endure(clock, clock_path, options.minutes, options.seed)), flush=True)
            for fault in options.faults if options.tries else ():
                driver = Driver(clock_path, options.seed)
                tries: list[dict[str, float]] = []
                for _ in range(options.tries):
                    found, driver = fault_try(fault, stand_in, clock, driver, log)
                    tries.append(found)
                driver.end()
                print(json.dumps({"fault": fault} | summary(tries)), flush=True)


def summary(tries: list[dict[str, float]]) -> dict[str, float]:
    """Of all tries of a fault: how many, in how many the arm moved, and median and largest of the rest."""
    figures = {name: np.array([one[name] for one in tries]) for name in tries[0]}
    counts = {name: int(figures.pop(name).sum()) for name in COUNTED if name in figures}
    return {
        "tries": len(tries),
        **counts,
        **{f"{name}_median": round(float(np.median(one)), 3) for name, one in figures.items()},
        **{f"{name}_max": round(float(one.max()), 3) for name, one in figures.items()},
    }


if __name__ == "__main__":
    main()
