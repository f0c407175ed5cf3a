"""Any arm behind ros2_control: Kinova, UR and others."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import REASONS, ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.real import Findings, GuidableArm
from latentarm.arms.ros2.gripper import Ros2Gripper
from latentarm.arms.ros2.inspection import inspect
from latentarm.arms.ros2.joint_states import JointFeed, Measured
from latentarm.arms.ros2.link import Link, check_installed
from latentarm.arms.ros2.options import read_options
from latentarm.arms.ros2.session import Session
from latentarm.core.errors import UserError
from latentarm.core.punctuality import OwnPauses
from latentarm.core.types import Command, GripperCommand, GripperReading, Reading
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

RATE_HZ: Final = 100.0  # of the watchdog's commands to the controller
STOPS_AFTER_S: Final = 0.09  # largest delay of the watchdog's braking after a command has run out
LONGEST_S: Final = 0.5  # the watchdog would cut a longer command short
HEARTBEAT_S: Final = 0.05  # largest gap between messages to the watchdog
_JUMPED: Final = (
    "The clock of the joint states has jumped: let nothing set the clock of the arm's computer meanwhile."
)
CLAIM_S: Final = 1.0  # for the watchdog to give us the arm


@final
@dataclass(frozen=True)
class _Open:
    link: Link
    session: Session
    feed: JointFeed
    gripper: Ros2Gripper | None
    claimed: bool = False  # whether the watchdog has given us the arm; else nothing is told to it

    def close(self) -> None:
        """Give the arm back and end the connection."""
        if self.claimed:
            self.session.tell("release")
        self.link.close()


@final
class Ros2Arm(GuidableArm):
    """The driver of an arm behind ros2_control, over rosbridge.

    Commands go to the watchdog next to the arm, which passes them on to the controller and stops the arm when
    they end. A thread tells the watchdog that this process lives, and after `recover` opens a lost connection
    again. The address is rosbridge's, with the options of `Ros2Options`.
    """

    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        check_installed()
        self._options = read_options(address, robot)
        self._robot, self._gripper = robot, robot.gripper
        self._dof = robot.dof
        self._now_s = now_s
        self._spec = ArmSpec(
            robot.joint_names, RATE_HZ, STOPS_AFTER_S, simulated=False, gripper=robot.gripper
        )
        self._open: _Open | None = None
        self._lost = ""
        self._fault = ""
        self._arming: int | None = None
        self._enablings = 0
        self._reading: Reading | None = None
        self._measured: Measured | None = None
        self._reconnect = threading.Event()
        self._ended = threading.Event()
        self._heart: threading.Thread | None = None
        self._pauses = OwnPauses()

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        if self._open is not None:
            raise RuntimeError("the arm is connected; look before that")
        opened = self._opened()
        try:
            return inspect(opened.link, opened.session, opened.feed, self._options, self._robot)
        finally:
            opened.link.close()

    def connect(self) -> None:
        if self._open is not None and not self._out_of_reach():
            return
        self._begin(self._claimed)

    def watch(self) -> None:
        """Connect to read; another client may have the arm meanwhile."""
        self._begin(self._fit)

    def _begin(self, opened: Callable[[], _Open]) -> None:
        self.close()
        self._open = opened()
        self._take_reading()
        self._ended.clear()
        self._heart = threading.Thread(target=self._beat, name="latentarm-ros2", daemon=True)
        self._heart.start()

    def close(self) -> None:
        self._ended.set()
        self._arming = None
        if self._heart is not None:
            self._heart.join()
            self._heart = None
        if self._open is not None:
            self._open.close()
        self._open, self._lost, self._fault = None, "", ""
        self._reconnect.clear()

    def read(self) -> Reading:
        self._take_reading()
        if self._reading is None:
            raise RuntimeError("an arm has no reading before it is connected")
        return self._reading

    def status(self) -> ArmStatus:
        opened = self._open
        if opened is None:
            return ArmStatus("off", REASONS["off"])
        lost = self._lost or self._out_of_reach()
        state = opened.session.state
        if lost or state is None:
            return ArmStatus("fault", lost, recoverable=True, lost=True)
        if state.stop_pressed:
            return ArmStatus("emergency_stop", "The emergency stop on the arm is pressed.")
        if self._fault or opened.feed.jumped:
            said = self._fault or _JUMPED
            return ArmStatus("fault", said, recoverable=True)
        if state.phase == "latched":
            return ArmStatus("fault", state.reason, recoverable=True)
        if self._arming is not None and state.phase == "armed" and state.arming == self._arming:
            said = "" if opened.gripper is None else opened.gripper.failure
            newest = opened.feed.newest
            moves = newest is not None and np.abs(newest[0].dq).max() > STILL_RAD_S
            return ArmStatus("moving" if moves else "ready", said)
        return ArmStatus("disabled", state.obstacle or REASONS["disabled"])

    def enable(self) -> None:
        if self._open is not None and self.status().phase == "disabled":
            if self._arming is None:
                self._enablings += 1
                self._arming = self._enablings
            self._open.session.tell("enable", arming=self._arming)

    def disable(self) -> None:
        self._arming = None
        if self._open is not None:
            self._open.session.tell("disable")
            self._halt_gripper(self._open)

    def guide(self) -> None:
        """Always refused: ros2_control has no common way to let go of an arm."""
        raise UserError(
            "This arm is not released over ROS 2: switch on its own mode for guiding by hand at the arm, such"
            " as freedrive, and record here while you move it."
        )

    def move_gripper(self, command: GripperCommand) -> None:
        opened, status = self._open, self.status()
        if opened is not None and opened.gripper is not None and not (status.lost or status.takes_commands):
            opened.gripper.command(command)

    def recover(self) -> None:
        opened = self._open
        if opened is None or self.status().phase != "fault":
            return
        self._arming = None
        if self._lost or self._out_of_reach():
            self._reconnect.set()
            return
        self._fault, opened.feed.jumped = "", False
        opened.session.tell("recover")

    def send(self, command: Command) -> None:
        velocity = finite_velocity(command, self._dof)
        if command.gripper is not None and self._gripper is None:
            raise ValueError("this arm has no gripper to command")
        opened = self._open
        if opened is None or not self.status().takes_commands:
            return
        state = opened.session.state
        if state is None:
            return
        # The watchdog has the joints in the controller's order.
        ordered = [float(velocity[self._options.joints.index(joint)]) for joint in state.joints]
        opened.session.tell(
            "command",
            arming=self._arming,
            duration=min(max(float(command.duration_s), 0.0), LONGEST_S),
            velocity=ordered,
        )
        if opened.gripper is not None and command.gripper is not None:
            opened.gripper.command(command.gripper)

    def stop(self) -> None:
        if self._open is not None:
            self._open.session.tell("stop")
            self._halt_gripper(self._open)

    def _opened(self) -> _Open:
        link = Link(self._options.host, self._options.port)
        session = Session(link, self._options.watchdog, self._now_s)
        feed = JointFeed(link, self._options, self._now_s)
        gripper = None if self._gripper is None else Ros2Gripper(link, self._options, self._gripper)
        return _Open(link, session, feed, gripper)

    def _fit(self) -> _Open:
        """A new connection to an arm that can be driven; nothing is claimed."""
        opened = self._opened()
        refusals = inspect(opened.link, opened.session, opened.feed, self._options, self._robot).refusals
        if refusals:
            opened.close()
            raise UserError(refusals[0])
        return opened

    def _claimed(self) -> _Open:
        """A new connection that owns the arm, which is disabled."""
        opened = replace(self._fit(), claimed=True)
        opened.session.tell("claim")
        until_s = self._now_s() + CLAIM_S
        while not opened.session.ours and self._now_s() < until_s:
            time.sleep(0.01)
        if not opened.session.ours:
            opened.close()
            raise UserError("Another client drives the arm: end it there first.")
        return opened

    def _out_of_reach(self) -> str:
        """Why the arm cannot be reached over this connection, as one sentence, or ""."""
        opened = self._open
        if opened is None or not opened.link.connected:
            advice = self._pauses.or_else("check the cable, and that rosbridge runs there")
            return f"The connection to the arm's computer is lost: {advice}."
        if opened.session.silent:
            advice = self._pauses.or_else("check the cable, and that the watchdog runs there")
            return f"Nothing comes from the watchdog next to the arm any more: {advice}."
        if opened.claimed and not opened.session.ours:
            return "The watchdog has given the arm to another client, or was started again: connect again."
        return ""

    def _take_reading(self) -> None:
        opened, before = self._open, self._reading
        newest = None if opened is None else opened.feed.newest
        if opened is None or newest is None or newest[0] is self._measured:
            return
        measured, time_s = newest
        position = opened.feed.gripper
        gripper: GripperReading | None = None
        if opened.gripper is not None and position is not None:
            gripper = opened.gripper.measured(position)
        # After a new connection the clocks are reckoned anew: time must not seem to go back.
        time_s = time_s if before is None else max(time_s, before.time_s)
        sequence = 0 if before is None else before.sequence + 1
        self._measured = measured
        self._reading = Reading(measured.q, measured.dq, time_s, sequence, gripper)

    def _halt_gripper(self, opened: _Open) -> None:
        if opened.gripper is not None:
            opened.gripper.halt()

    def _beat(self) -> None:
        """The heartbeat thread, until the arm is closed."""
        while True:
            self._pauses.wait(self._ended, HEARTBEAT_S)
            opened = self._open
            if opened is None or self._ended.is_set():
                return
            lost = self._lost or self._out_of_reach()
            if not lost:
                if opened.feed.jumped and not self._fault:
                    self._fault = _JUMPED
                    self._arming = None
                    if opened.claimed:
                        opened.session.tell("disable")
                if opened.claimed:
                    opened.session.tell("heartbeat")
            elif not self._lost:
                # What waits in this connection must never reach the arm.
                self._lost, self._arming = lost, None
                opened.link.close()
            elif self._reconnect.is_set():
                self._reconnect.clear()
                try:
                    self._open = self._claimed()
                except UserError as error:
                    self._lost = str(error)
                else:
                    self._lost = self._fault = ""
