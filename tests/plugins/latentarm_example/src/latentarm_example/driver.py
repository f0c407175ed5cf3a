"""The driver of a real arm. A simulated arm stands for the library of its maker."""

from collections.abc import Callable

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import ArmSpec, ArmStatus, finite_velocity
from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.real import Fact, Findings, RealArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, Reading
from latentarm.robots.robot import Robot

STOPS_AFTER_S = 0.02  # the controller ends a command by itself, so late at most


class ExampleArm(RealArm):
    """Its calls return at once, as the library's do; else a thread of the driver would make them."""

    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        self._firmware = address.only("firmware").get("firmware", "2.0")
        self._dof = robot.dof
        self._library = KinematicArm(robot, robot.home, now_s)
        self._spec = ArmSpec(robot.joint_names, 100.0, STOPS_AFTER_S, simulated=False, gripper=robot.gripper)

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        refusals = () if self._firmware >= "2.0" else ("The firmware is too old: update it to 2.0.",)
        return Findings((Fact("firmware", self._firmware),), refusals)

    def connect(self) -> None:
        for refusal in self.look().refusals:
            raise UserError(refusal)
        self._library.connect()

    def watch(self) -> None:
        self.connect()  # this library claims nothing by connecting

    def close(self) -> None:
        self._library.close()

    def read(self) -> Reading:
        return self._library.read()

    def status(self) -> ArmStatus:
        return self._library.status()

    def enable(self) -> None:
        self._library.enable()

    def disable(self) -> None:
        self._library.disable()

    def recover(self) -> None:
        self._library.recover()

    def send(self, command: Command) -> None:
        finite_velocity(command, self._dof)
        self._library.send(command)  # with its duration, so that the controller ends it

    def move_gripper(self, command: GripperCommand) -> None:
        self._library.move_gripper(command)

    def stop(self) -> None:
        self._library.stop()
