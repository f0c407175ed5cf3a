"""Shadow mode: a real arm whose readings count, and to which no command is ever sent."""

from dataclasses import replace
from typing import final

from latentarm.arms.contract import Arm, ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.real import RealArm
from latentarm.core.types import Command, GripperCommand, Reading


@final
class ShadowArm(Arm):
    """Stands between the loop and a real arm, which it watches and never commands.

    It can be enabled and then takes commands, as an arm does, and drops them. The arm itself is only read: it
    is not enabled, recovered, guided or claimed, and no setting of it changes. Whatever stops the arm stops
    its shadow; a fault ends when the arm is connected again.
    """

    def __init__(self, arm: RealArm) -> None:
        self._arm = arm
        self._spec = replace(arm.spec, follows=False)
        self._enabled = False

    @property
    def spec(self) -> ArmSpec:
        """That of the arm, but that it does not follow."""
        return self._spec

    def connect(self) -> None:
        """Connect to read."""
        self._enabled = False
        self._arm.watch()

    def close(self) -> None:
        """End the connection."""
        self._enabled = False
        self._arm.close()

    def read(self) -> Reading:
        """The arm's newest reading."""
        return self._arm.read()

    def status(self) -> ArmStatus:
        """*ready* once it is enabled and the arm has no fault."""
        status = self._arm.status()
        if status.phase in ("off", "fault", "emergency_stop"):
            self._enabled = False
            fault = status.phase == "fault"
            # Recovering would tell the arm something; connecting again does not.
            return replace(status, recoverable=False, lost=status.lost or fault)
        if self._enabled:
            return ArmStatus("ready")
        return ArmStatus("disabled", "Shadow mode is not enabled.")

    def enable(self) -> None:
        """Take commands, and drop them."""
        self._enabled = self.status().phase == "disabled"

    def disable(self) -> None:
        """Take no commands."""
        self._enabled = False

    def recover(self) -> None:
        """Nothing: the arm is not told anything."""

    def send(self, command: Command) -> None:
        """Check a command as a driver does, and drop it."""
        finite_velocity(command, len(self._spec.joint_names))

    def move_gripper(self, command: GripperCommand) -> None:
        """Drop a command to the gripper."""

    def stop(self) -> None:
        """Nothing moves because of us."""
