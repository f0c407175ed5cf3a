"""An arm that breaks when it is told to."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import final

from latentarm.arms.contract import Arm, ArmSpec, ArmStatus
from latentarm.core.types import Command, GripperCommand, Reading


@final
class FaultyArm(Arm):
    """Any arm, with faults of the arm itself and of the way to it.

    Several faults may hold at once. Each lasts until `repair` is called, except for the two that stop the
    arm: these end as on a real arm, by releasing the button and by `recover`.
    """

    def __init__(self, arm: Arm, now_s: Callable[[], float]) -> None:
        self.arm = arm
        self._now_s = now_s
        self._late_s = 0.0
        self._waiting: deque[Reading] = deque()
        self._reached: Reading | None = None
        self._silent = False
        self._frozen: Reading | None = None
        self._cut = False
        self._pressed = False
        self._broken: ArmStatus | None = None

    def delay_readings(self, by_s: float) -> None:
        """Readings arrive this much later than they were taken, s."""
        self._late_s = by_s

    def silence(self) -> None:
        """No new readings arrive, as when the driver is killed."""
        self._silent = True

    def freeze(self) -> None:
        """New readings have the old figures, as when an encoder is stuck."""
        self._frozen = self.read()

    def cut(self) -> None:
        """Neither readings nor commands arrive, as when a cable is pulled out."""
        self._silent = self._cut = True

    def repair(self) -> None:
        """End the faults above."""
        self._late_s, self._silent, self._cut, self._frozen = 0.0, False, False, None

    def press_emergency_stop(self) -> None:
        """Somebody presses the button on the arm."""
        self._pressed = True
        self.arm.disable()

    def release_emergency_stop(self) -> None:
        """The button is released; the arm stays disabled."""
        self._pressed = False

    def break_down(self, reason: str, *, recoverable: bool) -> None:
        """The arm finds a fault in itself and stops, as after a collision."""
        self._broken = ArmStatus("fault", reason, recoverable)
        self.arm.disable()

    @property
    def spec(self) -> ArmSpec:
        return self.arm.spec

    def connect(self) -> None:
        self.arm.connect()
        self._waiting.clear()
        self._reached = self.arm.read()

    def close(self) -> None:
        self.arm.close()

    def read(self) -> Reading:
        newest = self.arm.read()
        reached = self._reached
        if reached is None:
            raise RuntimeError("an arm has no reading before it is connected")
        if (self._waiting[-1] if self._waiting else reached).sequence < newest.sequence:
            self._waiting.append(newest)
        while not self._silent and self._waiting and self._arrived(self._waiting[0]):
            reached = self._reached = self._waiting.popleft()
        return reached if self._frozen is None else replace(reached, q=self._frozen.q, dq=self._frozen.dq)

    def status(self) -> ArmStatus:
        status = self.arm.status()
        if status.phase == "off":
            return status
        if self._pressed:
            return ArmStatus("emergency_stop", "The emergency stop on the arm is pressed.")
        return self._broken or status

    def enable(self) -> None:
        if self.status().phase == "disabled":
            self.arm.enable()

    def disable(self) -> None:
        self.arm.disable()

    def recover(self) -> None:
        if self._broken is not None and self._broken.recoverable:
            self._broken = None

    def send(self, command: Command) -> None:
        if not self._cut:
            self.arm.send(command)

    def move_gripper(self, command: GripperCommand) -> None:
        if not self._cut:
            self.arm.move_gripper(command)

    def stop(self) -> None:
        if not self._cut:
            self.arm.stop()

    def _arrived(self, reading: Reading) -> bool:
        return self._now_s() - reading.time_s >= self._late_s - 1e-9
