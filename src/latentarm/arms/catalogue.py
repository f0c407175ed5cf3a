"""Arms by name, and real ones by the scheme of their address: ours, and those that others register."""

import inspect
from collections.abc import Callable
from typing import Any, Final, Protocol, TypeVar, cast

from latentarm.arms.address import ArmAddress, is_address, parse_address
from latentarm.arms.contract import Arm, SceneArm
from latentarm.arms.real import RealArm
from latentarm.core.errors import UserError
from latentarm.core.plugins import Catalogue
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene

T = TypeVar("T")


class ArmFactory(Protocol):
    """Makes an arm; its class is such a factory."""

    def __call__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
        """An arm that is not connected, with readings on the clock ``now_s``, s, which never goes back.

        A simulated arm starts at ``state`` (n,), rad; a real arm ignores it.
        """
        ...


class SceneArmFactory(Protocol):
    """Makes an arm that can have things about it."""

    def __call__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float], *, scene: Scene) -> Arm:
        """An arm that is not connected, in a scene; see `ArmFactory`."""
        ...


class RealArmFactory(Protocol):
    """Makes the driver of a real arm; its class is such a factory."""

    def __call__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> RealArm:
        """A driver that is not connected, with readings on the clock ``now_s``, s, which never goes back.

        Raises UserError where an option of the address is unknown or out of range, or the manufacturer's
        library is not installed.
        """
        ...


def _factory(name: str, thing: object) -> Any:
    if not callable(thing):
        raise TypeError(f"{thing!r} is not a class or function that makes an arm")
    return thing


ARMS: Final[Catalogue[ArmFactory]] = Catalogue(
    "latentarm.arms",
    "arm",
    {"kinematic": "latentarm.arms.kinematic:KinematicArm", "mujoco": "latentarm.arms.mujoco:MujocoArm"},
    _factory,
)

DEFAULT_ARM: Final = "kinematic"
PHYSICAL_ARM: Final = "mujoco"  # can touch and hold things
REAL_ARMS: Final[Catalogue[RealArmFactory]] = Catalogue(
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


def make_arm(name: str, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
    """An arm of `ARMS`, or the real one at an address, not connected yet.

    A simulated arm starts at ``state`` (n,), rad, and moves as its clock ``now_s``, s, goes on, which never
    goes back; a real arm ignores ``state``.

    Raises UserError where there is no such arm, it does not load, it cannot be made for this robot, or is
    none.
    """
    if is_address(name):
        return make_real_arm(name, robot, now_s)
    return _checked(Arm, name, ARMS.find(name, "--arm")(robot, state, now_s))


def make_real_arm(address: str, robot: Robot, now_s: Callable[[], float]) -> RealArm:
    """The driver of a real arm, such as ``franka://172.16.0.2``; not connected yet."""
    where = parse_address(address)
    return _checked(RealArm, address, _driver(address, where)(robot, where, now_s))


def check_named(name: str) -> None:
    """Check the name or address in ``--arm``, without making the arm."""
    if is_address(name):
        _driver(name, parse_address(name))
    elif ":" in name:
        raise UserError(
            f"--arm {name} is no address of an arm: `latentarm arms list` shows their form, such as"
            f" {address_form('xarm')}."
        )
    else:
        ARMS.find(name, "--arm")


def check_simulated(name: str) -> None:
    """Check the name in ``--arm`` where time is simulated; see `check_named`."""
    if is_address(name):
        raise _real(name)
    check_named(name)


def make_simulated_arm(name: str, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
    """An arm for simulated time; see `make_arm`."""
    check_simulated(name)
    return _simulated(name, make_arm(name, robot, state, now_s))


def make_scene_arm(
    name: str, robot: Robot, state: FloatArray, now_s: Callable[[], float], scene: Scene
) -> SceneArm:
    """A simulated arm with things about it; only an arm whose factory takes a ``scene`` can have any."""
    check_simulated(name)
    factory = ARMS.find(name, "--arm")
    if "scene" not in inspect.signature(factory).parameters:
        raise UserError(f"--arm {name} has no things about it to touch or hold: use --arm {PHYSICAL_ARM}.")
    made = cast(SceneArmFactory, factory)(robot, state, now_s, scene=scene)
    return _checked(SceneArm, name, _simulated(name, _checked(Arm, name, made)))


def _driver(address: str, where: ArmAddress) -> RealArmFactory:
    return REAL_ARMS.find(where.scheme, f"--arm {address}")


def _simulated(name: str, arm: Arm) -> Arm:
    if not arm.spec.simulated:
        raise _real(name)
    return arm


def _real(name: str) -> UserError:
    return UserError(
        f"--arm {name} is a real arm, and time is simulated here: choose a simulated one, such as"
        f" {DEFAULT_ARM}."
    )


def _checked(kind: type[T], name: str, arm: object) -> T:
    if not isinstance(arm, kind):
        raise UserError(
            f"--arm {name} made {type(arm).__name__}, not a {kind.__module__}.{kind.__qualname__}."
        )
    return arm
