"""The driver of a Franka."""

import math
from collections.abc import Callable
from typing import Final, final

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import REASONS, ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.franka.hand import Hand
from latentarm.arms.franka.link import Link, findings, library, open_link, refusals, set_up
from latentarm.arms.franka.options import read_options
from latentarm.arms.franka.pace import measured_rate
from latentarm.arms.franka.worker import Order, Trouble, Worker
from latentarm.arms.real import Findings, GuidableArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, Reading
from latentarm.robots.robot import Robot

RATE_HZ: Final = 100.0
STOPS_AFTER_S: Final = 0.03
"""A motion that runs out is stopped within two cycles of 1 ms by franky's control thread. Where that has
ended, because the process was killed or the cable is cut, the arm itself stops after 20 cycles without a
message."""

_SILENT_S: Final = 0.5  # an arm that is silent for so long counts as lost


@final
class FrankaArm(GuidableArm):
    """A Franka Research 3 or Panda, by joint velocities at up to 100 Hz; its 1 kHz is franky's, in C++.

    Its address is ``franka://HOST`` with the options of `FrankaOptions`.
    """

    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        library()
        self._options = read_options(address)
        if robot.dof != 7:
            raise UserError(
                f"A Franka has 7 joints, and {robot.name} has {robot.dof}: choose the robot that the arm is."
            )
        if robot.tines is not None and not self._options.payload_kg:
            raise UserError(
                f"{robot.name} carries a fork: say what it weighs, such as"
                f" --arm franka://{address.host}?payload_kg=0.1."
            )
        self._robot = robot
        self._host = address.host
        self._now_s = now_s
        self._spec = ArmSpec(
            robot.joint_names, RATE_HZ, STOPS_AFTER_S, simulated=False, gripper=robot.gripper
        )
        self._worker: Worker | None = None
        self._hand: Hand | None = None
        self._enabled = False
        self._last: Reading | None = None

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        """Inspect the arm without moving it. Its collision thresholds do change, by connecting."""
        if self._worker is not None:
            raise RuntimeError("the arm is connected; look before that")
        link = open_link(self._host, self._options, self._robot)
        try:
            return findings(link, self._options, self._robot)
        finally:
            link.close()

    def connect(self) -> None:
        self._begin(ready=True)

    def watch(self) -> None:
        """Connect to read. Franky itself sets the arm's collision thresholds by connecting, to its own."""
        self._begin(ready=False)

    def _begin(self, *, ready: bool) -> None:
        self.close()
        link = self._link(ready=ready)
        # franky and libfranka raise exceptions of their own.
        try:
            self._hand = self._new_hand(link)
            self._worker = Worker(link, self._reconnected, self._now_s)
        except Exception as error:
            link.close()
            raise UserError(
                f"{self._host} sends no state ({error}): check its cable and connect again."
            ) from error

    def close(self) -> None:
        self._enabled = False
        if self._worker is not None:
            self._last = self.read()
            self._worker.close()
            self._worker = None
        if self._hand is not None:
            self._hand.close()
            self._hand = None

    def read(self) -> Reading:
        if self._worker is None:
            if self._last is None:
                raise RuntimeError("the arm was never connected")
            return self._last
        measured = self._worker.measured
        last = self._last
        if last is None or measured.time_s > last.time_s:
            sequence = 0 if last is None else last.sequence + 1
            fingers = None if self._hand is None else self._hand.reading
            last = Reading(
                measured.q, measured.dq, measured.time_s, sequence, fingers, measured.external_torque
            )
            self._last = last
        return last

    def status(self) -> ArmStatus:
        worker = self._worker
        if worker is None:
            return ArmStatus("off", REASONS["off"])
        self._watch(worker)
        trouble = worker.trouble
        if trouble is not None:
            self._enabled = False
            return ArmStatus(trouble.phase, trouble.reason, trouble.recoverable, trouble.lost)
        if worker.guided:
            return ArmStatus("guided", "The arm is guided by hand.")
        if not self._enabled or worker.in_torque_control:
            return ArmStatus("disabled", "The arm is connected and not enabled.")
        return ArmStatus("moving" if worker.running else "ready")

    def enable(self) -> None:
        if self._worker is not None and self.status().phase == "disabled":
            if not self._enabled:
                self._halt()
            self._enabled = True

    def disable(self) -> None:
        self._enabled = False
        self._halt()

    def guide(self) -> None:
        """Ask to be moved by hand. It ends within a second where this process does."""
        if self._worker is not None and not self._enabled and self.status().phase == "disabled":
            self._worker.guide()

    def move_gripper(self, command: GripperCommand) -> None:
        if self._worker is not None and self._hand is not None and not self.status().takes_commands:
            self._hand.ask(command)

    def recover(self) -> None:
        """Ask to end a recoverable fault. A lost connection is made again; the hand's too."""
        if self._worker is not None:
            self._enabled = False
            self._worker.recover()

    def send(self, command: Command) -> None:
        velocity = finite_velocity(command, 7)
        if not math.isfinite(command.duration_s):
            raise ValueError("a command needs a finite duration")
        worker = self._worker
        if worker is None or not self.status().takes_commands:
            return
        slowed = worker.limits.slowed(velocity, worker.measured.q)
        worker.give(Order(slowed, self._now_s() + command.duration_s))
        if command.gripper is not None and self._hand is not None:
            self._hand.ask(command.gripper)

    def stop(self) -> None:
        self._halt()

    def _halt(self) -> None:
        if self._worker is not None:
            self._worker.give(Order(None, self._now_s()))

    def _watch(self, worker: Worker) -> None:
        """Detect faults that the worker cannot: it waits for a silent arm, or the hand is gone."""
        silent_s = self._now_s() - worker.measured.time_s
        if silent_s > _SILENT_S:
            advice = worker.pauses.or_else("check its power and cable")
            reason = f"Nothing has come from the arm for {silent_s:.1f} s: {advice}."
            worker.fail(Trouble("fault", reason, recoverable=True, lost=True))
        elif self._hand is not None and self._hand.lost:
            reason = f"The connection to the hand was lost ({self._hand.lost}): check its cable."
            worker.fail(Trouble("fault", reason, recoverable=True, lost=True))

    def _link(self, *, ready: bool) -> Link:
        """A link to an arm that can be driven; ``ready`` sets the arm up for that."""
        link = open_link(self._host, self._options, self._robot)
        try:
            for reason in refusals(link, self._options, self._robot, measured_rate(link.arm)):
                raise UserError(reason)
            if ready:
                set_up(link, self._options, self._robot)
        except Exception:
            link.close()
            raise
        return link

    def _reconnected(self) -> Link:
        """A new link in place of a lost one, with its hand; in the worker's thread."""
        if self._hand is not None:
            self._hand.close()
        link = self._link(ready=True)
        self._hand = self._new_hand(link)
        return link

    def _new_hand(self, link: Link) -> Hand | None:
        if link.hand is None or self._robot.gripper is None:
            return None
        return Hand(link.hand, self._robot.gripper)
