"""How fast an arm stops whose readings cannot be true, and how far its tool moves until then.

    python scripts/implausible_arms.py --arms 50 [--json]

Simulated Pandas are driven through `ControlLoop` at 100 Hz, each in a direction, at a speed (0.1 to 0.5 rad/s
for its fastest joint) and from a configuration of its own (seeds 0 to arms - 1). At a moment of its own a
fault begins:

- frozen: all joint readings stay as they are; the arm goes on as commanded;
- jumping: one reading is 1.5 rad off from then on;
- lagging: readings come ever later, by 50 ms more in every 100 ms;
- blocked: the joint that is moved fastest is held and does not move any more; its encoder works;
- drifting: one joint is pushed away at 0.2 rad/s on top of its commands.

A stop is the first command of zero. Distances are of the tool, by the simulated plant, and by the commands.
"""

import argparse
import json
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console
from rich.table import Table

from latentarm.arms.catalogue import make_arm
from latentarm.arms.contract import Arm, ArmSpec, ArmStatus
from latentarm.control.clock import SimulatedClock
from latentarm.control.controller import Controller
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.safety.config import SafetyConfig
from latentarm.control.step import Step
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.types import Command, Context, FloatArray, GripperCommand, Input, Reading, StepRecord

PERIOD_S = 0.01
ENCODER_NOISE_RAD = 1e-5
FAULTS = ("frozen", "jumping", "lagging", "blocked", "drifting")


class Straight(Controller):
    """Moves all joints in one direction, as far as the person pushes."""

    def __init__(self, direction: FloatArray) -> None:
        self._direction = direction

    @property
    def modes(self) -> tuple[str, ...]:
        """See the base class."""
        return ("straight",)

    @property
    def input_dim(self) -> int:
        """See the base class."""
        return 1

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return z * self._direction


class Push(InputSource):
    """Lets go at first, and then pushes."""

    def __init__(self) -> None:
        self._ticks = 0

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        self._ticks += 1
        return Input(np.full(1, float(self._ticks > 5))), 0.0


class ImplausibleArm(Arm):
    """A simulated arm with a fault from a moment on.

    Args:
        plant: what moves.
        fault: one of `FAULTS`.
        at_s: when the fault begins, s.
        rng: which joint it is of, and the encoders' noise.
    """

    def __init__(self, plant: Arm, fault: str, at_s: float, rng: np.random.Generator) -> None:
        self.plant = plant
        self._fault, self._at_s, self._rng = fault, at_s, rng
        self._joint = int(rng.integers(len(plant.spec.joint_names)))
        self._sign = float(rng.choice([-1.0, 1.0]))
        self._past: list[Reading] = []
        self._held: int | None = None

    @property
    def spec(self) -> ArmSpec:
        """See the base class."""
        return self.plant.spec

    def connect(self) -> None:
        """See the base class."""
        self.plant.connect()

    def close(self) -> None:
        """See the base class."""
        self.plant.close()

    def read(self) -> Reading:
        """What the encoders say."""
        true = self.plant.read()
        if not self._past or self._past[-1].sequence < true.sequence:
            self._past.append(true)
        faulty = self._faulty(true)
        ticks_since = round((true.time_s - self._at_s) / PERIOD_S)
        q = true.q
        if faulty and self._fault == "frozen":
            return replace(true, q=self._past[-1 - ticks_since].q)
        if faulty and self._fault == "lagging":
            q = self._past[max(len(self._past) - 1 - round(0.5 * ticks_since), 0)].q
        if self._fault != "frozen":
            q = q + self._rng.normal(scale=ENCODER_NOISE_RAD, size=len(q))
        if faulty and self._fault == "jumping":
            q[self._joint] += 1.5 * self._sign
        return replace(true, q=q)

    def status(self) -> ArmStatus:
        """See the base class."""
        return self.plant.status()

    def enable(self) -> None:
        """See the base class."""
        self.plant.enable()

    def disable(self) -> None:
        """See the base class."""
        self.plant.disable()

    def recover(self) -> None:
        """See the base class."""
        self.plant.recover()

    def send(self, command: Command) -> None:
        """See the base class."""
        velocity = command.velocity.copy()
        faulty = self._faulty(self.plant.read())
        if faulty and self._fault == "blocked" and velocity.any():
            if self._held is None:
                self._held = int(np.abs(velocity).argmax())
            velocity[self._held] = 0.0
        if faulty and self._fault == "drifting":
            velocity[self._joint] += 0.2 * self._sign
        self.plant.send(Command(velocity, command.duration_s))

    def move_gripper(self, command: GripperCommand) -> None:
        """See the base class."""
        self.plant.move_gripper(command)

    def stop(self) -> None:
        """See the base class."""
        self.plant.stop()

    def _faulty(self, reading: Reading) -> bool:
        """Whether the fault has begun."""
        return reading.time_s >= self._at_s


@dataclass(frozen=True)
class Outcome:
    """One arm.

    Attributes:
        stop_s: from the fault to the first command of zero, s; None where the arm was still driven after 5 s.
        true_m: how far the tool moved since the fault, by the plant, m.
        commanded_m: how far it was commanded to move, m.
        reason: why it stopped.
    """

    stop_s: float | None
    true_m: float
    commanded_m: float
    reason: str


def drive(robot: Robot, fault: str, seed: int) -> Outcome:
    """Drive one arm into its fault."""
    rng = np.random.default_rng([FAULTS.index(fault), seed])
    while True:
        start = robot.home + rng.uniform(-0.3, 0.3, robot.dof)
        direction = rng.normal(size=robot.dof)
        direction *= rng.uniform(0.1, 0.5) / np.abs(direction).max()
        inside = robot.limits.violation(start + 3.0 * direction).max() <= 0.0
        if inside:
            break
    at_s = 0.01 * int(rng.integers(50, 100))
    clock = SimulatedClock()
    arm = ImplausibleArm(make_arm("kinematic", robot, start, clock.now_s), fault, at_s, rng)
    arm.connect()
    step = Step(robot, Straight(direction), SafetyConfig(), dt_s=PERIOD_S)
    records: list[StepRecord] = []
    states: list[FloatArray] = []

    def observe(record: StepRecord) -> None:
        records.append(record)
        states.append(arm.plant.read().q)
        if len(records) == 2:
            loop.enable()

    loop = ControlLoop(step, arm, Push(), clock, [observe])
    loop.run(ticks=round((at_s + 5.0) / PERIOD_S))
    first = next(index for index, record in enumerate(records) if record.time_s >= at_s - 1e-9)
    speeds = np.array([np.abs(record.command.velocity).max() for record in records])
    stopped = next((i for i, r in enumerate(records) if i >= first and r.command.stop is not None), None)
    last = len(records) - 1
    stop_s = None
    if stopped is not None and "ended" not in (reason := _reason(records[stopped])):
        last = stopped + int(np.argmax(speeds[stopped:] == 0.0))
        stop_s = records[last].time_s - at_s
    else:
        reason = "still driven after 5 s"
        last = first + 500
    commanded = start + np.cumsum([np.zeros(7), *(r.command.velocity * PERIOD_S for r in records)], axis=0)
    return Outcome(
        stop_s, _way(robot, np.array(states), first, last), _way(robot, commanded, first, last), reason
    )


def _reason(record: StepRecord) -> str:
    return "" if record.command.stop is None else record.command.stop.reason


def _way(robot: Robot, states: FloatArray, first: int, last: int) -> float:
    """How far the tool got from where it was, at most, m."""
    tools = robot.chain.forward(states[first : last + 1]).position
    return float(np.linalg.norm(tools - tools[0], axis=-1).max())


def figures(values: list[float]) -> list[float]:
    """Median, 95th percentile and worst, in thousandths."""
    return [round(1000.0 * float(np.percentile(values, share)), 1) for share in (50, 95, 100)]


def summary(fault: str, outcomes: list[Outcome]) -> dict[str, object]:
    """One row of the table."""
    stops = [one.stop_s for one in outcomes if one.stop_s is not None]
    return {
        "fault": fault,
        "arms": len(outcomes),
        "stopped": len(stops),
        "stop_ms": figures(stops) if stops else None,
        "true_mm": figures([one.true_m for one in outcomes]),
        "commanded_mm": figures([one.commanded_m for one in outcomes]),
    }


def main() -> None:
    """Drive them all, and print a table or JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=50, help="of each kind")
    parser.add_argument("--json", action="store_true")
    config = parser.parse_args()
    robot = panda()
    rows = [summary(fault, [drive(robot, fault, seed) for seed in range(config.arms)]) for fault in FAULTS]
    if config.json:
        print(json.dumps(rows, indent=1))
        return
    table = Table("fault", "stopped", "time to stop (ms)", "tool moved (mm)", "tool commanded (mm)")
    for row in rows:
        texts = [
            " / ".join(map(str, row[key])) if row[key] else "-"
            for key in ("stop_ms", "true_mm", "commanded_mm")
        ]
        table.add_row(str(row["fault"]), f"{row['stopped']} of {row['arms']}", *texts)
    Console().print(table, "median / 95th percentile / worst")


if __name__ == "__main__":
    main()
