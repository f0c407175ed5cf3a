"""The contract of an arm, real or simulated, with the control loop."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType
from typing import Final, Literal, Self, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Command, FloatArray, GripperCommand, Reading
from latentarm.robots.gripper import Gripper
from latentarm.robots.notices import assumed_limits
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import SceneState

ArmPhase = Literal["off", "disabled", "guided", "ready", "moving", "fault", "emergency_stop"]
"""Phases of an arm, see `ArmStatus`."""

STOPS_AFTER_S: Final = 0.1  # an arm that takes longer to notice the end of its commands is refused, s

INPUT_BUDGET_S: Final = 0.2  # the largest `ArmSpec.input_budget_s` of a real arm, s
SIMULATED_INPUT_BUDGET_S: Final = 0.6  # that of a simulated one, which a page may drive from far away, s


@final
@dataclass(frozen=True)
class ArmSpec:
    """An arm's fixed properties, by its driver."""

    joint_names: tuple[str, ...]  # n names, in the order of readings and commands
    rate_hz: float  # largest rate of commands, 1/s
    # When a command's ``duration_s`` has passed without another one, the arm begins to stop by itself within
    # this time, s. None if unknown: such an arm is refused.
    stops_after_s: float | None
    simulated: bool  # `check_arm` is stricter with real arms
    gripper: Gripper | None = None  # None where it has none
    follows: bool = True  # whether it carries out commands; a `latentarm.arms.shadow.ShadowArm` drops them
    # Inputs from a page count if they answer a state of the arm that is no older than this, s.
    input_budget_s: float = INPUT_BUDGET_S


@final
@dataclass(frozen=True)
class ArmStatus:
    """The state of an arm: ready to move, or why not."""

    # *off*: not connected. *disabled*: connected, takes no commands. *guided*: disabled, and moved by a
    # person's hand (`latentarm.arms.real.GuidableArm`). *ready*: enabled, at rest. *moving*: enabled, in
    # motion. *fault*: stopped by itself, takes no commands. *emergency_stop*: somebody has pressed the button
    # on the arm.
    phase: ArmPhase
    reason: str = ""  # one short sentence for the person, or ""
    recoverable: bool = False  # whether `Arm.recover` can end the fault
    # Whether the connection is lost. Recovering a recoverable fault then makes a new one; otherwise call
    # `Arm.close` and `Arm.connect`.
    lost: bool = False

    @property
    def takes_commands(self) -> bool:
        """Whether a command moves the arm now."""
        return self.phase in ("ready", "moving")


REASONS: Final[dict[ArmPhase, str]] = {
    "off": "The arm is not connected.",
    "disabled": "The arm is not enabled yet.",
}


class Arm(ABC):
    """An arm driven by joint velocities of bounded duration.

    Once a command's ``duration_s`` has passed without another one, the arm comes to rest by itself, however
    the process that drives it ended. Only a command sent while it is enabled moves it (its gripper also
    `move_gripper`): connecting, reconnecting, enabling, recovering and closing never do, and earlier commands
    do not count afterwards.

    Only `connect` and `close` wait for the arm. As a context manager it connects, and closes at the end.
    """

    @property
    @abstractmethod
    def spec(self) -> ArmSpec:
        """The arm's fixed properties, known before it is connected."""

    @abstractmethod
    def connect(self) -> None:
        """Open the connection, or open it again; then there is a first reading, and the arm is disabled.

        Raises:
            UserError: there is no arm, or it does not fit its robot.
        """

    @abstractmethod
    def close(self) -> None:
        """Stop the arm and end the connection; closing twice is harmless."""

    @abstractmethod
    def read(self) -> Reading:
        """The newest reading, however old it is; RuntimeError where the arm was never connected."""

    @abstractmethod
    def status(self) -> ArmStatus:
        """Whether the arm can move, and if not, why."""

    @abstractmethod
    def enable(self) -> None:
        """Ask a disabled arm to take commands; `status` says when it does."""

    @abstractmethod
    def disable(self) -> None:
        """Stop the arm, and take no commands until it is enabled again."""

    @abstractmethod
    def recover(self) -> None:
        """Ask an arm to end a recoverable fault; it is then disabled."""

    @abstractmethod
    def send(self, command: Command) -> None:
        """Take a command in place of the one before; an arm that is not enabled ignores it.

        Raises:
            ValueError: a figure has the wrong shape or is not finite; no safety filter sends that.
        """

    @abstractmethod
    def move_gripper(self, command: GripperCommand) -> None:
        """Move the gripper of an arm that takes no commands, if it can be reached.

        This replaces the command before. It stops the gripper, and may open it, while the arm is disabled,
        guided by hand, or has a fault.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stop now and forget the last command; the arm stays enabled."""

    @final
    def __enter__(self) -> Self:
        self.connect()
        return self

    @final
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


class SceneArm(Arm, ABC):
    """A simulated arm with things about it."""

    @abstractmethod
    def scene_state(self) -> SceneState:
        """The true state of everything, independent of readings.

        Repeated calls at one moment give the same state. Forces are the largest since the state of an earlier
        moment, so a single reader at every tick misses none.
        """


def finite_velocity(command: Command, dof: int) -> FloatArray:
    """A copy of a command's velocity, (n,), rad/s; ValueError unless it has n finite entries."""
    velocity = np.array(command.velocity, dtype=np.float64)
    if velocity.shape != (dof,) or not np.isfinite(velocity).all():
        raise ValueError(f"a command needs {dof} finite joint velocities, rad/s")
    return velocity


def check_arm(spec: ArmSpec, robot: Robot) -> None:
    """Refuse an arm that cannot be driven safely as this robot."""
    for refusal in arm_refusals(spec, robot):
        raise UserError(refusal)


def check_rate(spec: ArmSpec, dt_s: float) -> None:
    """Refuse an arm that takes fewer commands per second than a loop of period ``dt_s`` sends."""
    if spec.rate_hz < (1.0 - 1e-9) / dt_s:
        raise UserError(
            f"The loop runs at {1.0 / dt_s:g} Hz, but the arm takes {spec.rate_hz:g} commands"
            " per second: choose a lower rate."
        )


def arm_refusals(spec: ArmSpec, robot: Robot) -> tuple[str, ...]:
    """Reasons why an arm cannot be driven safely, a sentence each.

    Its joints are not the robot's, or the robot's gripper is missing; nobody knows when it stops by itself,
    or it is too late; its inputs may be too old; or the arm is real and one of its limits is assumed.
    """
    found: list[str] = []
    if spec.joint_names != robot.joint_names:
        found.append(
            f"The arm has the joints {', '.join(spec.joint_names)}, and {robot.name} has"
            f" {', '.join(robot.joint_names)}: choose the robot that the arm is."
        )
    if spec.stops_after_s is None or not 0.0 <= spec.stops_after_s <= STOPS_AFTER_S:
        known = "It is not known whether this arm"
        if spec.stops_after_s is not None and not math.isnan(spec.stops_after_s):
            known = f"This arm takes {1000 * spec.stops_after_s:.0f} ms until it"
        found.append(
            f"{known} stops by itself when no more commands come: an arm must do so within"
            f" {1000 * STOPS_AFTER_S:.0f} ms."
        )
    if robot.gripper is not None and spec.gripper is None:
        found.append(f"{robot.name} has a gripper, and the arm has none: choose the robot that the arm is.")
    kind, most_s = ("simulated", SIMULATED_INPUT_BUDGET_S) if spec.simulated else ("real", INPUT_BUDGET_S)
    if not 0.0 < spec.input_budget_s <= most_s:
        found.append(
            f"This arm takes inputs that answer a state {1000 * spec.input_budget_s:.0f} ms old: the driver"
            f" of a {kind} arm must state an input_budget_s of {most_s:g} s at most."
        )
    assumed = assumed_limits(robot)
    if assumed and not spec.simulated:
        found.append(
            f"A real arm is driven by known limits alone, and those of {robot.name} are assumed in part"
            f" ({assumed}): `latentarm robots {robot.name} --write-limits limits.toml` writes a file in which"
            " to state the manufacturer's figures; then name it with --limits."
        )
    return tuple(found)
