"""Real arms by the scheme of their address: ours, and those that other distributions register."""

from collections.abc import Callable
from typing import Final, Protocol, cast

from latentarm.arms.address import ArmAddress, parse_address
from latentarm.arms.real import RealArm
from latentarm.core.errors import UserError
from latentarm.core.plugins import Catalogue
from latentarm.robots.robot import Robot


class RealArmFactory(Protocol):
    """Makes the driver of a real arm; its class is such a factory."""

    def __call__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> RealArm:
        """A driver that is not connected.

        Args:
            robot: the arm's model.
            address: of the arm.
            now_s: the clock of readings, s; never goes back.

        Raises:
            UserError: an option of the address is unknown or out of range, or the manufacturer's library is
                not installed.
        """
        ...


def _factory(name: str, thing: object) -> RealArmFactory:
    if not callable(thing):
        raise TypeError(f"{thing!r} is not a class or function that makes the driver of an arm")
    return cast(RealArmFactory, thing)


REAL_ARMS: Final = Catalogue(
    "latentarm.real_arms",
    "driver",
    {
        "franka": "latentarm.arms.franka.arm:FrankaArm",
        "lerobot": "latentarm.arms.lerobot.arm:LerobotArm",
        "ros2": "latentarm.arms.ros2.arm:Ros2Arm",
        "xarm": "latentarm.arms.xarm.arm:XArm",
    },
    _factory,
)

_FORMS: Final = {
    "lerobot": "lerobot://TYPE?port=/dev/ttyACM0&id=NAME",
    "ros2": "ros2://HOST:PORT?controller=NAME",
}


def address_form(scheme: str) -> str:
    """The form of an address with this scheme; capitals are placeholders."""
    return _FORMS.get(scheme, f"{scheme}://HOST")


def check_address(address: str) -> None:
    """Check that there is a driver for an address."""
    REAL_ARMS.find(parse_address(address).scheme, f"--arm {address}")


def make_real_arm(address: str, robot: Robot, now_s: Callable[[], float]) -> RealArm:
    """The driver of a real arm, such as ``franka://172.16.0.2``; not connected yet."""
    where = parse_address(address)
    return _checked(address, REAL_ARMS.find(where.scheme, f"--arm {address}")(robot, where, now_s))


def _checked(address: str, arm: object) -> RealArm:
    if not isinstance(arm, RealArm):
        raise UserError(f"--arm {address} made {type(arm).__name__}, not a latentarm.arms.real.RealArm.")
    return arm
