"""How fast an arm comes to rest after a fault in motion, driven by the control loop in simulated time."""

from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np

from latentarm.arms.catalogue import ArmFactory
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import SimulatedClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.types import BoolArray, FloatArray, Input, Reading, StepRecord
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm.testing.faults import FaultyArm

Fault = Literal[
    "stop_pressed",
    "driver_killed",
    "readings_end",
    "encoders_frozen",
    "readings_late",
    "emergency_stop",
    "collision",
]

FAULTS: Final[dict[Fault, str]] = {
    "stop_pressed": "the person presses Stop",
    "driver_killed": "neither commands nor readings get through any more",
    "readings_end": "commands get through, but no new readings",
    "encoders_frozen": "new readings have the old figures",
    "readings_late": "readings begin to arrive 60 ms late",
    "emergency_stop": "the button on the arm is pressed",
    "collision": "the arm stops by itself with a fault that can be recovered from",
}
"""What happens while the arm moves."""

PERIOD_S: Final = 0.01
_STOPPED_S: Final = 0.6  # from the fault until it is repaired, s
_WAITING_S: Final = 0.3  # from then on the stick is still pushed, without anybody having enabled the arm, s
_TOO_LATE_S: Final = 0.06


@final
@dataclass(frozen=True)
class FaultTrial:
    """One fault in motion."""

    zero_command_s: float  # from the fault to the first command of zero that only zeros follow, s
    rest_s: float  # from the fault until every joint stands still for good, as the arm itself knows it, s
    moved_rad: float
    """How far a joint moved once the fault was repaired, with the stick still pushed and before anybody
    enabled the arm, rad."""
    moves_again: bool  # whether the arm moves once the stick was let go and the arm was enabled
    reason: str  # what the person read


@final
class _Stick(InputSource):
    """Pushed one way, or neutral."""

    def __init__(self, push: FloatArray) -> None:
        self._push = push
        self.pushed = False

    def latest(self, now_s: float) -> tuple[Input, float]:
        return Input(self._push if self.pushed else np.zeros_like(self._push)), 0.0


def try_fault(make: ArmFactory, robot: Robot, fault: Fault, seed: int, late_s: float = 0.0) -> FaultTrial:
    """Drive an arm by its tool, let a fault happen in motion, and look at what follows.

    The seed draws the direction, and when it happens. Readings are ``late_s`` late from the beginning.
    """
    rng = np.random.default_rng([list(FAULTS).index(fault), seed])
    clock = SimulatedClock()
    arm = make(robot, robot.home, clock.now_s)
    faulty = FaultyArm(arm, clock.now_s)
    faulty.connect()
    angle = rng.uniform(0.0, 2.0 * np.pi)
    stick = _Stick(np.array([np.cos(angle), np.sin(angle)]))
    step = Step(robot, EndEffectorController(robot), SafetyConfig(), dt_s=PERIOD_S)
    records: list[StepRecord] = []
    truth: list[Reading] = []
    at = int(rng.integers(60, 100))
    repaired = at + round(_STOPPED_S / PERIOD_S)
    again = repaired + round(_WAITING_S / PERIOD_S)

    def observe(record: StepRecord) -> None:
        records.append(record)
        truth.append(arm.read())
        tick = len(records) - 1
        if tick in (2, again + 2):
            loop.enable()
        if tick == at:
            _happen(fault, faulty, loop)
        if tick == repaired:
            faulty.repair()
            faulty.release_emergency_stop()
        stick.pushed = 5 <= tick < again or tick > again + 5

    loop = ControlLoop(step, faulty, stick, clock, [observe])
    faulty.delay_readings(late_s)
    loop.run(again + 50)
    since = truth[at].time_s
    commands = np.array([np.abs(record.command.velocity).max() for record in records])
    speeds = np.array([np.abs(reading.dq).max() for reading in truth])
    return FaultTrial(
        zero_command_s=records[_last(commands[:repaired] > 0.0) + 1].time_s - since,
        rest_s=truth[_last(speeds[:repaired] > STILL_RAD_S) + 1].time_s - since,
        moved_rad=float(np.abs(truth[again].q - truth[repaired].q).max()),
        moves_again=bool(speeds[again + 20] > STILL_RAD_S),
        reason="" if (stop := records[repaired - 1].command.stop) is None else stop.reason,
    )


def _happen(fault: Fault, arm: FaultyArm, loop: ControlLoop) -> None:
    match fault:
        case "stop_pressed":
            loop.stop("Stop was pressed.")
        case "driver_killed":
            arm.cut()
        case "readings_end":
            arm.silence()
        case "encoders_frozen":
            arm.freeze()
        case "readings_late":
            arm.delay_readings(_TOO_LATE_S)
        case "emergency_stop":
            arm.press_emergency_stop()
        case "collision":
            arm.break_down("The arm has hit something.", recoverable=True)


def _last(true: BoolArray) -> int:
    """Index of the last one that is true; -1 where none is."""
    found = np.flatnonzero(true)
    return int(found[-1]) if len(found) else -1
