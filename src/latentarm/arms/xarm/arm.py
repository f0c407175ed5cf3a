"""The driver of a UFACTORY arm."""

import time
from collections.abc import Callable
from functools import partial
from typing import Final, final

import numpy as np

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import REASONS, ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.real import Findings, GuidableArm
from latentarm.arms.xarm.controller import ANSWER_S, LinkLostError
from latentarm.arms.xarm.driver import Driver
from latentarm.arms.xarm.findings import basic_facts, find_out, too_different
from latentarm.arms.xarm.reports import JointReport
from latentarm.arms.xarm.sdk import load_sdk
from latentarm.arms.xarm.session import Session, read_options
from latentarm.arms.xarm.state import TAKES_COMMANDS, Ordered, Shared
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, GripperReading, Reading
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

RATE_HZ: Final = 100.0
_CYCLE_S: Final = 0.02  # of the controller, including its reaction to the end of a command
_JOIN_S: Final = 8.0


@final
class XArm(GuidableArm):
    """xArm 5, 6 and 7, 850 and Lite 6.

    Each command leaves with the rest of its duration, counted from `send`; the controller ends it by itself.
    Commands not delivered within `latentarm.arms.xarm.controller.ANSWER_S` are dropped, so a command ends at
    most that much later.

    The robot's joints are J1, J2, ... in order. The address is ``xarm://HOST[:PORT]``, see
    `latentarm.arms.xarm.session.Options`.
    """

    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        self._options = read_options(address)
        self._sdk = load_sdk()
        self._host = address.host
        self._robot, self._now_s = robot, now_s
        self._shared = Shared()
        self._driver: Driver | None = None
        self._last: tuple[JointReport, GripperReading | None] | None = None
        self._spec = ArmSpec(
            robot.joint_names, RATE_HZ, ANSWER_S + _CYCLE_S, simulated=False, gripper=robot.gripper
        )

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        session: Session | None = None
        try:
            session = Session(self._sdk, self._host, self._options, self._robot, self._now_s)
            if refusals := too_different(session.identity, self._robot):
                return Findings(basic_facts(session.identity), refusals)
            session.listen()
            return find_out(self._sdk, session, self._robot, bare=self._options.bare)
        except LinkLostError as error:
            raise UserError(str(error)) from error
        finally:
            if session is not None:
                session.close()

    def connect(self) -> None:
        self._begin(clears=True)

    def watch(self) -> None:
        self._begin(clears=False)

    def _begin(self, *, clears: bool) -> None:
        self.close()
        session = self._open(0 if self._last is None else self._last[0].number, clear=False)
        self._shared = Shared(condition="disabled")
        reopen = partial(self._open, clear=clears)
        self._driver = Driver(self._sdk, self._robot, self._shared, session, reopen, clears=clears)
        self._driver.start()

    def close(self) -> None:
        driver, self._driver = self._driver, None
        if driver is None:
            return
        self._last = self._newest(driver)
        with self._shared.changed:
            self._shared.become("off")
            self._shared.ending = True
            self._shared.changed.notify_all()
        driver.join(_JOIN_S)

    def read(self) -> Reading:
        if self._driver is not None:
            self._last = self._newest(self._driver)
        if self._last is None:
            raise RuntimeError("the arm was never connected")
        report, gripper = self._last
        return Reading(report.q.copy(), report.dq.copy(), report.measured_s, report.number, gripper)

    def status(self) -> ArmStatus:
        with self._shared.changed:
            condition, reason = self._shared.condition, self._shared.reason
            recoverable = self._shared.recoverable
        match condition:
            case "off":
                return ArmStatus("off", REASONS["off"])
            case "disabled":
                return ArmStatus("disabled", "The arm is not enabled.")
            case "enabling":
                return ArmStatus("disabled", "The arm is being enabled.")
            case "releasing":
                return ArmStatus("disabled", "The arm is being switched to its manual mode.")
            case "guided":
                return ArmStatus("guided", "The arm is guided by hand.")
            case "enabled" | "stopping":
                return ArmStatus("moving" if np.abs(self.read().dq).max() > STILL_RAD_S else "ready")
            case "fault" | "lost":
                return ArmStatus("fault", reason, recoverable, lost=condition == "lost")
            case "emergency_stop":
                return ArmStatus("emergency_stop", reason, recoverable)

    def enable(self) -> None:
        with self._shared.changed:
            if self._shared.condition == "disabled":
                self._shared.become("enabling")
                self._shared.requests.add("enable")

    def disable(self) -> None:
        with self._shared.changed:
            if self._shared.condition in (*TAKES_COMMANDS, "enabling", "releasing", "guided"):
                self._shared.become("disabled")
                self._shared.requests.add("halt")

    def guide(self) -> None:
        """Ask to be moved by hand. If this process is killed, the arm stays in its manual mode."""
        with self._shared.changed:
            if self._shared.condition == "disabled":
                self._shared.become("releasing")
                self._shared.requests.add("guide")

    def move_gripper(self, command: GripperCommand) -> None:
        driver = self._driver
        takes_commands = self._shared.condition in TAKES_COMMANDS
        if driver is not None and driver.session.gripper is not None and not takes_commands:
            driver.session.gripper.send(command)

    def recover(self) -> None:
        with self._shared.changed:
            if self._shared.condition in ("fault", "lost") and self._shared.recoverable:
                self._shared.requests.add("recover")
                self._shared.changed.notify_all()

    def send(self, command: Command) -> None:
        velocity = finite_velocity(command, self._robot.dof)
        driver = self._driver
        with self._shared.changed:
            if driver is None or self._shared.condition not in TAKES_COMMANDS:
                return
            self._shared.command = Ordered(velocity, time.monotonic() + command.duration_s)
            self._shared.changed.notify_all()
        if command.gripper is not None and driver.session.gripper is not None:
            driver.session.gripper.send(command.gripper)

    def stop(self) -> None:
        with self._shared.changed:
            self._shared.command = None
            if self._shared.condition in TAKES_COMMANDS:
                self._shared.become("stopping")
                self._shared.requests.add("stop")

    def _newest(self, driver: Driver) -> tuple[JointReport, GripperReading | None]:
        session = driver.session
        return session.report, None if session.gripper is None else session.gripper.reading

    def _open(self, number: int, *, clear: bool) -> Session:
        """Another session; ``clear`` clears an error at somebody's request."""
        session: Session | None = None
        try:
            session = Session(self._sdk, self._host, self._options, self._robot, self._now_s)
            refusals = too_different(session.identity, self._robot)
            if not refusals:
                session.listen(number)
                if clear:
                    session.controller.clear()
                refusals = find_out(self._sdk, session, self._robot, bare=self._options.bare).refusals
            if refusals:
                raise UserError(refusals[0])
        except BaseException as error:
            if session is not None:
                session.close()
            if isinstance(error, LinkLostError):
                raise UserError(str(error)) from error
            raise
        return session
