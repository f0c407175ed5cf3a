"""How long a LeRobot arm takes to come to rest when the process that drives it is killed or stalls.

    python scripts/lerobot_stops.py [--tries 20] [--out FILE.json]

It runs in an environment with LeRobot 0.6 (`make lerobot`). No arm is needed: LeRobot's own class and the
servos' own SDK talk to `tests/arms/feetech_bus.py`, simulated STS3215 servos behind a serial port. Another
process drives all joints at 0.5 rad/s, to and fro, by commands of 50 ms. At a random moment it is killed
(SIGKILL) or stopped (SIGSTOP), or the process next to the bus is killed. All times count from that signal:
until the servos are told nothing new, and until their encoders stand still. The servos follow their goals
with a simulated lag of 50 ms; what real ones add is not known.
"""

import argparse
import json
import multiprocessing
import os
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final

import numpy as np

from latentarm.arms.address import parse_address
from latentarm.arms.lerobot.arm import LerobotArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.types import Command
from latentarm.robots.catalogue import load_robot

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from arms.feetech_bus import GOAL, FeetechBus

MOTORS: Final = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
SPEED_RAD_S: Final = 0.5
HOLD_S: Final = 0.05
TURN_RAD: Final = 0.5
STEP_RAD: Final = 2.0 * np.pi / 4096.0

FAULTS: Final = {
    "killed": "driving process killed (SIGKILL)",
    "stalled": "driving process stalled (SIGSTOP)",
    "keeper": "process next to the bus killed (SIGKILL)",
}


@dataclass(frozen=True)
class Trial:
    """One fault: times since the signal, s; the way since then, rad."""

    told_s: float
    rest_s: float
    way_rad: float


def _model(folder: Path) -> Path:
    bodies = "".join(f'<body pos="0 0 0.1"><joint name="{name}"/><geom size="0.02"/>' for name in MOTORS[:5])
    path = folder / "so101.xml"
    path.write_text(
        '<mujoco><compiler angle="radian"/><default><joint axis="0 1 0" range="-1.5 1.5"/></default>'
        f'<worldbody>{bodies}<site name="tool"/>{"</body>" * 5}</worldbody></mujoco>'
    )
    return path


def _drive(model: str, address: str, told: Connection) -> None:
    """Drive to and fro until killed; first say what process each fault happens to."""
    clock = MonotonicClock()
    arm = LerobotArm(load_robot(model), parse_address(address), clock.now_s)
    arm.connect()
    arm.enable()
    while not arm.status().takes_commands:
        clock.wait_until(clock.now_s() + 0.01)
    (keeper,) = [
        int(one) for one in Path(f"/proc/self/task/{os.getpid()}/children").read_text().split() if _keeps(one)
    ]
    told.send({"killed": os.getpid(), "stalled": os.getpid(), "keeper": keeper})
    way = 1.0
    while True:
        at = arm.read().q[0]
        way = -np.sign(at) if abs(at) > TURN_RAD else way
        arm.send(Command(np.full(5, way * SPEED_RAD_S), duration_s=HOLD_S))
        clock.wait_until(clock.now_s() + 0.01)


def _keeps(pid: str) -> bool:
    return "latentarm.arms.lerobot.keeper" in Path(f"/proc/{pid}/cmdline").read_text()


def _trial(bus: FeetechBus, pid: int, how: signal.Signals) -> Trial:
    at_s = time.monotonic()
    os.kill(pid, how)
    time.sleep(0.7)
    goals = [(when_s, number, data) for when_s, number, address, data in bus.written() if address == GOAL]
    final = {number: data for _, number, data in goals}
    told_s = max((when_s for when_s, number, data in goals if data != final[number]), default=at_s)
    # What differed last was replaced in the next write.
    told_s = min((when_s for when_s, *_ in goals if when_s > told_s), default=told_s)
    trace = bus.trace()
    begun = next(places for when_s, places in trace if when_s >= at_s)
    rest_s = max(when_s for (when_s, places), (_, after) in pairwise(trace) if places != after)
    way = max(abs(one - other) for one, other in zip(begun, trace[-1][1], strict=True)) * STEP_RAD
    return Trial(max(told_s - at_s, 0.0), max(rest_s - at_s, 0.0), way)


def _tries(fault: str, tries: int, folder: Path) -> list[Trial]:
    rng, context = np.random.default_rng(0), multiprocessing.get_context("spawn")
    trials: list[Trial] = []
    model = _model(folder)
    calibration = folder / "bench.json"
    ranges = {"drive_mode": 0, "homing_offset": 0, "range_min": 1000, "range_max": 3000}
    calibration.write_text(
        json.dumps({name: {"id": index + 1, **ranges} for index, name in enumerate(MOTORS)})
    )
    while len(trials) < tries:
        with FeetechBus() as bus:
            reading, writing = context.Pipe(duplex=False)
            address = f"lerobot://so101_follower?port={bus.port}&calibration={calibration}"
            driver = context.Process(target=_drive, args=(str(model), address, writing), daemon=True)
            driver.start()
            pids = reading.recv()
            try:
                if fault != "stalled":
                    time.sleep(float(rng.uniform(0.2, 0.8)))
                    trials.append(_trial(bus, pids[fault], signal.SIGKILL))
                while fault == "stalled" and len(trials) < tries:
                    time.sleep(float(rng.uniform(0.2, 0.8)))
                    trials.append(_trial(bus, pids[fault], signal.SIGSTOP))
                    os.kill(pids[fault], signal.SIGCONT)
            finally:
                driver.kill()
                driver.join()
    return trials


def _figures(trials: list[Trial]) -> dict[str, Any]:
    def times(values: list[float]) -> dict[str, float]:
        return {
            "mean": round(float(np.mean(values)), 2),
            "sd": round(float(np.std(values, ddof=1)), 2),
            "most": round(max(values), 2),
        }

    return {
        "tries": len(trials),
        "told nothing new after, ms": times([1000.0 * one.told_s for one in trials]),
        "encoders still after, ms": times([1000.0 * one.rest_s for one in trials]),
        "way, deg": times([float(np.rad2deg(one.way_rad)) for one in trials]),
    }


def main() -> None:
    """Try every fault."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--faults", nargs="+", choices=FAULTS, default=list(FAULTS))
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    figures: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        for fault in options.faults:
            figures[FAULTS[fault]] = _figures(_tries(fault, options.tries, Path(folder)))
            print(FAULTS[fault], json.dumps(figures[FAULTS[fault]]), flush=True)
    if options.out is not None:
        options.out.write_text(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
