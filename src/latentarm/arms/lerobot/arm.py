"""A LeRobot arm as an arm of ours: ``lerobot://so101_follower?port=/dev/ttyACM0&calibration=FILE.json``."""

import weakref
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any, Final, cast, final

import numpy as np

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import REASONS, ArmPhase, ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.helper_process import HelperProcess
from latentarm.arms.lerobot import keeper
from latentarm.arms.lerobot.options import Options
from latentarm.arms.own_pose import compared, kind_misfit
from latentarm.arms.real import Fact, Findings, GuidableArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, GripperReading, Reading
from latentarm.robots.robot import Robot

RATE_HZ: Final = 100.0  # of the servos' targets
STOPS_AFTER_S: Final = 0.05
"""Its process sees that a command has run out in its next round; a round takes 10 ms, and 50 ms at most where
the bus is slow. A process that is slower than that, or killed, tells the servos nothing new."""

_LOADING_S: Final = 240.0  # for importing LeRobot
_BUS_S: Final = 10.0  # for opening and asking the bus
_ENDING_S: Final = 2.0
_SILENT_S: Final = 1.0  # a process that is silent for so long does not answer


@final
class LerobotArm(GuidableArm):
    """An arm of LeRobot whose servos take positions, driven next to its bus by a separate process.

    The servos have no watchdog. The process makes up for that (`latentarm.arms.lerobot.keeper`): it turns
    velocities into position targets, each command for its duration, and the last target stands when commands
    end for any reason. The arm then holds its position under power. Neither disabling nor closing lets it
    drop; to lower it, switch its supply off with a hand under it. The robot's joints have the names of the
    motors. For the address see `Options`.
    """

    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        if find_spec("lerobot") is None:
            raise UserError(
                "--arm lerobot:// needs LeRobot 0.6, which needs Python 3.12 or newer: pip install"
                " 'latentarm[lerobot]'."
            )
        self._robot, self._now_s = robot, now_s
        self._options = Options.of(address)
        self._asked = 0
        self._newest: Reading | None = None
        self._status = ArmStatus("off", REASONS["off"])
        self._heard_s = -np.inf
        self._open = False
        self._process: HelperProcess | None = None
        self._described: dict[str, Any] = {}
        self._begin()
        gripper = robot.gripper if self._described["gripper"] else None
        motors = tuple(self._described["joints"])
        joints = robot.joint_names if set(motors) == set(robot.joint_names) else motors
        self._spec = ArmSpec(joints, RATE_HZ, STOPS_AFTER_S, simulated=False, gripper=gripper)

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        answer = self._ask("look")
        facts = {"arm": self._options.kind, "port": self._options.port}
        facts |= cast("dict[str, str]", answer["facts"])
        facts["stop time"] = (
            f"{1000 * STOPS_AFTER_S:.0f} ms after the last command the servos are told nothing new and hold"
            " their positions; they stay under power when the arm is closed"
        )
        listed = (Fact(name, value) for name, value in facts.items())
        return Findings((*listed, compared((), self._robot)), (*self._misfits(), *answer["refusals"]))

    def connect(self) -> None:
        if self._open and self._alive:
            return
        if misfits := self._misfits():
            raise UserError(misfits[0])
        state = self._ask("connect")
        self._open = True
        self._take(state)

    def watch(self) -> None:
        """Connect to read: the motors are told nothing before the arm is enabled."""
        self.connect()

    def close(self) -> None:
        """Stop the arm and close its bus; it holds its position under power."""
        if self._open and self._alive:
            try:
                self._ask("close")
            except UserError:
                self._end()
        self._open = False
        self._status = ArmStatus("off", REASONS["off"])

    def read(self) -> Reading:
        if self._newest is None:
            raise RuntimeError("an arm has no reading before it is connected")
        self._drain()
        return self._newest

    def status(self) -> ArmStatus:
        self._drain()
        if self._open and keeper.now_s() - self._heard_s > _SILENT_S:
            return ArmStatus(
                "fault",
                "The process next to the arm does not answer; the arm holds its position. Connect it again.",
                lost=True,
            )
        return self._status

    def enable(self) -> None:
        self._tell("enable")

    def disable(self) -> None:
        self._tell("disable")
        if self._status.takes_commands:
            self._status = ArmStatus("disabled", REASONS["disabled"])

    def guide(self) -> None:
        """Ask to be moved by hand, with the joints' torque off: the arm sinks unless somebody holds it."""
        self._tell("guide")

    def move_gripper(self, command: GripperCommand) -> None:
        """Move the gripper of an arm that takes no commands; any hand opens a jaw without torque."""
        self._tell("grip", gripper=[command.width_m, command.speed_m_s])

    def recover(self) -> None:
        self._tell("recover")

    def send(self, command: Command) -> None:
        velocity = finite_velocity(command, self._robot.dof)
        gripper = command.gripper
        self._tell(
            "move",
            velocity=velocity.tolist(),
            duration_s=max(float(command.duration_s), 0.0),
            sent_s=keeper.now_s(),
            gripper=None if gripper is None else [gripper.width_m, gripper.speed_m_s],
        )

    def stop(self) -> None:
        self._tell("stop")

    @property
    def _alive(self) -> bool:
        return self._process is not None and self._process.alive

    def _begin(self) -> HelperProcess:
        """Start the process next to the bus, which describes the arm."""
        process = HelperProcess("latentarm.arms.lerobot.keeper")
        self._process = process
        # Closing keeps it, because LeRobot takes seconds to load; it ends with this object at the latest.
        self._ending = weakref.finalize(self, process.end, _ENDING_S)
        limits, gripper = self._robot.limits, self._robot.gripper
        process.port.send(
            {
                "options": self._options.message(),
                "joints": list(self._robot.joint_names),
                "lower": limits.lower.tolist(),
                "upper": limits.upper.tolist(),
                "speed": limits.velocity.tolist(),
                "width_m": None if gripper is None else gripper.width_m,
            }
        )
        try:
            described = process.port.receive(_LOADING_S)
        except EOFError:
            described = None
        if described is None or "refused" in described:
            self._end()
            raise UserError(
                "LeRobot does not start: its own message above says why."
                if described is None
                else described["refused"]
            )
        self._described = described
        return process

    def _end(self) -> None:
        self._ending()
        self._process = None

    def _misfits(self) -> tuple[str, ...]:
        if set(self._spec.joint_names) == set(self._robot.joint_names):
            return kind_misfit(self._options.kind, self._robot)
        return (
            f"{self._options.kind} has the motors {', '.join(self._spec.joint_names)}, and"
            f" {self._robot.name} has the joints {', '.join(self._robot.joint_names)}: choose the robot that"
            " the arm is.",
        )

    def _tell(self, what: str, **details: object) -> None:
        if self._open and self._process is not None:
            self._process.port.send({"do": what, **details})

    def _ask(self, what: str) -> dict[str, Any]:
        process = self._process
        if process is None or not process.alive:
            self._end()
            process = self._begin()
        self._asked += 1
        process.port.send({"do": what, "asked": self._asked})
        until_s = keeper.now_s() + _BUS_S
        while (left_s := until_s - keeper.now_s()) > 0.0:
            try:
                answer = process.port.receive(left_s)
            except EOFError:
                break
            if answer is not None and answer.get("asked") == self._asked:
                if "refused" in answer:
                    raise UserError(answer["refused"])
                return answer
        raise UserError(
            f"The process next to {self._options.port} does not answer: check the cable, and start again."
        )

    def _drain(self) -> None:
        if self._process is None or not self._open:
            return
        try:
            while (message := self._process.port.receive()) is not None:
                if "phase" in message and "asked" not in message:
                    self._take(message)
        except EOFError:
            self._heard_s = -np.inf

    def _take(self, state: Mapping[str, Any]) -> None:
        self._heard_s = keeper.now_s()
        phase: ArmPhase = state["phase"]
        reason = state["reason"] or REASONS.get(phase, "")
        lost = bool(state.get("lost"))
        self._status = ArmStatus(phase, reason, recoverable=phase == "fault", lost=lost)
        if "q" not in state:
            return
        # Its age counts, so that readings are timed by the loop's clock whatever that is.
        time_s = self._now_s() - max(self._heard_s - float(state["read_s"]), 0.0)
        width_m = state["width_m"]
        gripper = None if width_m is None else GripperReading(float(width_m), bool(state["holding"]))
        self._newest = Reading(
            q=np.array(state["q"], dtype=np.float64),
            dq=np.array(state["dq"], dtype=np.float64),
            time_s=time_s,
            sequence=0 if self._newest is None else self._newest.sequence + 1,
            gripper=gripper,
        )
