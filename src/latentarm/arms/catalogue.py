"""The arms by name: ours, and those that other distributions register."""

from collections.abc import Callable
from typing import Final, Protocol, cast

from latentarm.arms.contract import Arm, SimulatedArm
from latentarm.arms.live import LiveArm
from latentarm.errors import UserError
from latentarm.plugins import Catalogue
from latentarm.robots.robot import Robot
from latentarm.types import FloatArray


class ArmFactory(Protocol):
    """What makes an arm; the class of an arm does."""

    def __call__(self, robot: Robot, state: FloatArray) -> Arm:
        """An arm that has not moved.

        Args:
            robot: whose joints these are.
            state: (n,), where a simulated arm starts, rad; a real arm is where it is.
        """
        ...


def _factory(name: str, thing: object) -> ArmFactory:
    if not callable(thing):
        raise TypeError(f"{thing!r} is not a class or function that makes an arm")
    return cast(ArmFactory, thing)


ARMS: Final = Catalogue(
    "latentarm.arms", "arm", {"kinematic": "latentarm.arms.kinematic:KinematicArm"}, _factory
)

DEFAULT_ARM: Final = "kinematic"


def make_arm(name: str, robot: Robot, state: FloatArray) -> Arm:
    """An arm of the catalogue.

    Args:
        name: a name in `ARMS`.
        robot: whose joints these are.
        state: (n,), where a simulated arm starts, rad.

    Raises:
        UserError: there is no such arm, it does not load, it cannot be made for this robot, or it is not an
        arm.
    """
    arm = cast(object, ARMS.find(name, "--arm")(robot, state))  # a plug-in may break the contract
    if not isinstance(arm, Arm):
        raise UserError(f"--arm {name} made {type(arm).__name__}, not a latentarm.arms.contract.Arm.")
    return arm


def make_simulated_arm(name: str, robot: Robot, state: FloatArray) -> SimulatedArm:
    """An arm for simulated time; see `make_arm`.

    Raises:
        UserError: as `make_arm`, and where time cannot be simulated for the arm.
    """
    arm = make_arm(name, robot, state)
    if not isinstance(arm, SimulatedArm):
        raise UserError(
            f"--arm {name} is a real arm, and time is simulated here: choose a simulated one, such as"
            f" {DEFAULT_ARM}."
        )
    return arm


def make_live_arm(name: str, robot: Robot, state: FloatArray, now_s: Callable[[], float]) -> Arm:
    """An arm in real time: a simulated one moves as time passes; see `make_arm`.

    Args:
        name: a name in `ARMS`.
        robot: whose joints these are.
        state: (n,), where a simulated arm starts, rad.
        now_s: the time, s; never goes back.
    """
    arm = make_arm(name, robot, state)
    return LiveArm(arm, now_s) if isinstance(arm, SimulatedArm) else arm
