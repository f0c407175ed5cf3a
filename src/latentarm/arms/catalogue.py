"""Arms by name: ours, and those that other distributions register."""

import inspect
from collections.abc import Callable
from typing import Final, Protocol, cast

from latentarm.arms.address import is_address
from latentarm.arms.contract import Arm, SceneArm
from latentarm.arms.real_catalogue import check_address, make_real_arm
from latentarm.core.errors import UserError
from latentarm.core.plugins import Catalogue
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene


class ArmFactory(Protocol):
    """Makes an arm; its class is such a factory."""

    def __call__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
        """An arm that is not connected.

        Args:
            robot: the robot with these joints.
            state: (n,), start of a simulated arm, rad; a real arm ignores it.
            now_s: the clock of readings, s; never goes back.
        """
        ...


class SceneArmFactory(Protocol):
    """Makes an arm that can have things about it."""

    def __call__(self, robot: Robot, state: FloatArray, now_s: Callable[[], float], *, scene: Scene) -> Arm:
        """An arm that is not connected, in a scene; see `ArmFactory`."""
        ...


def _factory(name: str, thing: object) -> ArmFactory:
    if not callable(thing):
        raise TypeError(f"{thing!r} is not a class or function that makes an arm")
    return cast(ArmFactory, thing)


ARMS: Final = Catalogue(
    "latentarm.arms",
    "arm",
    {
        "kinematic": "latentarm.arms.kinematic:KinematicArm",
        "mujoco": "latentarm.arms.mujoco:MujocoArm",
    },
    _factory,
)

DEFAULT_ARM: Final = "kinematic"

PHYSICAL_ARM: Final = "mujoco"  # can touch and hold things


def make_arm(name: str, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
    """An arm of the catalogue, not connected yet.

    Args:
        name: a name in `ARMS`, or the address of a real arm.
        robot: the robot with these joints.
        state: (n,), start of a simulated arm, rad; a real arm ignores it.
        now_s: the clock of readings, s; never goes back. A simulated arm moves as it goes on.

    Raises:
        UserError: there is no such arm, it does not load, it cannot be made for this robot, or it is none.
    """
    if is_address(name):
        return make_real_arm(name, robot, now_s)
    return _checked(name, ARMS.find(name, "--arm")(robot, state, now_s))


def check_named(name: str) -> None:
    """Check the name or address in ``--arm``, without making the arm."""
    if is_address(name):
        check_address(name)
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
    arm = _simulated(name, _checked(name, cast(SceneArmFactory, factory)(robot, state, now_s, scene=scene)))
    if not isinstance(arm, SceneArm):
        raise UserError(f"--arm {name} made {type(arm).__name__}, not a latentarm.arms.contract.SceneArm.")
    return arm


def _simulated(name: str, arm: Arm) -> Arm:
    if not arm.spec.simulated:
        raise _real(name)
    return arm


def _real(name: str) -> UserError:
    return UserError(
        f"--arm {name} is a real arm, and time is simulated here: choose a simulated one, such as"
        f" {DEFAULT_ARM}."
    )


def _checked(name: str, arm: object) -> Arm:
    if not isinstance(arm, Arm):
        raise UserError(f"--arm {name} made {type(arm).__name__}, not a latentarm.arms.contract.Arm.")
    return arm
