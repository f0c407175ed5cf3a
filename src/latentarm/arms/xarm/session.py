"""One connection to an arm: requests, reports and the gripper."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, final

from latentarm.arms.address import ArmAddress
from latentarm.arms.xarm.controller import Controller, LinkLostError
from latentarm.arms.xarm.gripper import GripperLink
from latentarm.arms.xarm.identity import TIMED_REPORTS, Identity, read_identity
from latentarm.arms.xarm.reports import JointReport, JointReports, StatusReport, StatusReports
from latentarm.arms.xarm.sdk import Sdk
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot

COMMAND_PORT: Final = 502
_FIRST_REPORT_S: Final = 2.0


@final
@dataclass(frozen=True)
class Options:
    """Options of an address; None is the manufacturer's port."""

    command_port: int = COMMAND_PORT  # ``PORT`` of the address
    gripper_port: int | None = None  # for devices at the tool
    joints_port: int | None = None  # reports joint states
    status_port: int | None = None  # reports everything else
    bare: bool = False  # whether the arm carries nothing, not even a gripper


def read_options(address: ArmAddress) -> Options:
    """Read the options of an address."""
    given = address.only("gripper_port", "joints_port", "load", "status_port")
    load = given.get("load")
    if load not in (None, "none"):
        raise UserError(f"--arm xarm takes load=none for an arm that carries nothing, not load={load}.")
    ports = [_port(name, given) for name in ("gripper_port", "joints_port", "status_port")]
    return Options(address.port or COMMAND_PORT, *ports, bare=load == "none")


def _port(name: str, given: Mapping[str, str]) -> int | None:
    text = given.get(name)
    if text is None:
        return None
    if not text.isascii() or not text.isdigit() or not 0 < int(text) < 65536:
        raise UserError(f"--arm xarm: {name} is {text!r}, but ports are 1 to 65535.")
    return int(text)


@final
class Session:
    """One connection to an arm; opening and closing it moves nothing."""

    def __init__(
        self, sdk: Sdk, host: str, options: Options, robot: Robot, now_s: Callable[[], float]
    ) -> None:
        self._sdk, self._host, self._options, self._robot, self._now_s = sdk, host, options, robot, now_s
        self.gripper: GripperLink | None = None  # None where the robot has none
        self._status: StatusReports | None = None
        self._joints: JointReports | None = None
        self.controller = Controller(sdk, host, options.command_port)
        try:
            self.identity: Identity = read_identity(self.controller.version())
        except BaseException:
            self.close()
            raise

    def listen(self, first_number: int = 0) -> None:
        """Open everything besides requests, and wait for the first reports, numbered from a number on.

        Raises LinkLostError if a part of it cannot be reached, or does not answer as it should.
        """
        sdk, host, options, robot = self._sdk, self._host, self._options, self._robot
        timed = self.identity.firmware >= TIMED_REPORTS
        self._status = StatusReports(sdk, host, options.status_port)
        self._joints = JointReports(
            sdk, host, options.joints_port, robot.dof, timed=timed, now_s=self._now_s, number=first_number
        )
        if robot.gripper is not None:
            self.gripper = GripperLink(sdk, host, options.gripper_port, robot.gripper)
        self._first_reports()

    @property
    def joints(self) -> JointReports:
        """The stream of joint states."""
        if self._joints is None:
            raise RuntimeError("the session is not open")
        return self._joints

    @property
    def report(self) -> JointReport:
        """The newest joint states."""
        newest = self.joints.newest
        if newest is None:
            raise RuntimeError("the session is not open")
        return newest

    @property
    def status(self) -> StatusReport:
        """The newest report of everything else."""
        newest = None if self._status is None else self._status.newest
        if newest is None:
            raise RuntimeError("the session is not open")
        return newest

    @property
    def fault(self) -> str:
        """Why the connection or its clocks are unusable, or ""."""
        joints = self.joints
        streams = joints.stream.fault or ("" if self._status is None else self._status.stream.fault)
        return streams or joints.clock.fault or ("" if self.gripper is None else self.gripper.fault)

    def close(self) -> None:
        """End it; closing twice is harmless."""
        self.controller.close()
        if self.gripper is not None:
            self.gripper.close()
        for reports in (self._joints, self._status):
            if reports is not None:
                reports.stream.close()

    def _first_reports(self) -> None:
        until_s = time.monotonic() + _FIRST_REPORT_S
        joints, status = self.joints, self._status
        with joints.came:
            came = joints.came.wait_for(lambda: joints.newest is not None, _FIRST_REPORT_S)
        if status is None or not status.came.wait(max(0.0, until_s - time.monotonic())) or not came:
            raise LinkLostError(
                f"The controller at {self._host} has not reported for {_FIRST_REPORT_S:g} s: restart it,"
                " and check that its firmware is the one it states."
            )
