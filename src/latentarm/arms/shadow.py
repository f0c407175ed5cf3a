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
        return self._spec

    def connect(self) -> None:
        self._enabled = False
        self._arm.watch()

    def close(self) -> None:
        self._enabled = False
        self._arm.close()

    def read(self) -> Reading:
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
        self._enabled = self.status().phase == "disabled"

    def disable(self) -> None:
        self._enabled = False

    def recover(self) -> None:
        """Nothing: the arm is not told anything."""

    def send(self, command: Command) -> None:
        finite_velocity(command, len(self._spec.joint_names))

    def move_gripper(self, command: GripperCommand) -> None:
        """Drop a command to the gripper."""

    def stop(self) -> None:
        """Nothing moves because of us."""
