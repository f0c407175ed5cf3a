"""The base of simulated arms: when they take commands, and how their time passes."""

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.arms.contract import (
    REASONS,
    SIMULATED_INPUT_BUDGET_S,
    Arm,
    ArmPhase,
    ArmSpec,
    ArmStatus,
    finite_velocity,
)
from latentarm.arms.simulated_gripper import SimulatedGripper
from latentarm.core.errors import UserError
from latentarm.core.types import Command, FloatArray, GripperCommand, Reading
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

_CLOCK_DIGITS: Final = 9  # whole nanoseconds, so that equal periods are equally long
SETTLED_S: Final = 1.0  # an arm without a command is at rest by then


class SimulatedArm(Arm):
    """A simulated arm. It moves as its clock goes on, even if nobody reads it.

    With a real clock it lives in real time; with a simulated one, time passes when that does. Either way it
    stops by itself, as a real arm must: ``stops_after_s`` after a command has run out. Nothing moves for
    longer than ``settles_s`` after the last command; the simulation stops then. ``state`` (n,), rad, is the
    start, ``now_s`` the clock, s, which never goes back.

    Raises UserError where ``state`` has the wrong shape, is not finite, or lies outside the limits.
    """

    def __init__(
        self,
        robot: Robot,
        state: FloatArray,
        now_s: Callable[[], float],
        *,
        rate_hz: float,
        stops_after_s: float,
        gripper: SimulatedGripper | None = None,
        settles_s: float = SETTLED_S,
    ) -> None:
        check_start(robot, state)
        fingers = None if gripper is None else gripper.gripper
        self._spec = ArmSpec(
            robot.joint_names,
            rate_hz,
            stops_after_s,
            simulated=True,
            gripper=fingers,
            input_budget_s=SIMULATED_INPUT_BUDGET_S,
        )
        self._gripper, self._settles_s, self._now_s = gripper, settles_s, now_s
        self._at_s = now_s()
        self._phase: ArmPhase = "off"
        self._rest = np.zeros(robot.dof)
        self._commanded = self._rest
        self._left_s = 0.0
        self._newest: Reading | None = None
        self._read_at_s = self._at_s

    @abstractmethod
    def _pass(self, span_s: float, commanded: FloatArray) -> None:
        """Let time pass, ``span_s`` > 0, at a constant commanded velocity (n,), rad/s."""

    @abstractmethod
    def _measure(self) -> tuple[FloatArray, FloatArray, float]:
        """Positions (n,), rad, velocities (n,), rad/s, and their age, s; the caller owns the arrays."""

    def _external_torque(self) -> FloatArray | None:
        """See `Reading.external_torque`, of what `_measure` measured."""
        return None

    @abstractmethod
    def _halt(self) -> None:
        """Stop as fast as the arm can, after the command was taken back."""

    @property
    @final
    def spec(self) -> ArmSpec:
        return self._spec

    @final
    def connect(self) -> None:
        self._elapse()
        if self._phase == "off":
            self._phase = "disabled"
            self._renew()

    @final
    def close(self) -> None:
        self.disable()
        self._phase = "off"

    @final
    def read(self) -> Reading:
        if self._newest is None:
            raise RuntimeError("an arm has no reading before it is connected")
        self._elapse()
        if self._phase == "off" or self._read_at_s == self._at_s:
            return self._newest
        return self._renew()

    @final
    def status(self) -> ArmStatus:
        self._elapse()
        phase = self._phase
        if phase == "ready" and self._newest is not None and np.abs(self._newest.dq).max() > STILL_RAD_S:
            phase = "moving"
        return ArmStatus(phase, REASONS.get(phase, ""))

    @final
    def enable(self) -> None:
        if self._phase == "disabled":
            self._phase = "ready"

    @final
    def disable(self) -> None:
        self.stop()
        if self._phase == "ready":
            self._phase = "disabled"

    @final
    def recover(self) -> None:
        """Nothing: a simulated arm has no faults of its own."""

    @final
    def send(self, command: Command) -> None:
        velocity = finite_velocity(command, len(self._rest))
        if command.gripper is not None and self._gripper is None:
            raise ValueError("this arm has no gripper to command")
        self._elapse()
        if self._phase == "ready":
            self._commanded = velocity
            self._left_s = max(float(command.duration_s), 0.0)
            if self._gripper is not None and command.gripper is not None:
                self._gripper.send(command.gripper)

    @final
    def move_gripper(self, command: GripperCommand) -> None:
        self._elapse()
        if self._gripper is not None and self._phase == "disabled":
            self._gripper.send(command)

    @final
    def stop(self) -> None:
        self._elapse()
        self._commanded, self._left_s = self._rest, 0.0
        self._halt()
        if self._gripper is not None:
            self._gripper.halt()
        self._read_at_s = math.nan  # what was read in this moment no longer holds

    def _elapse(self) -> None:
        """Simulate up to the present."""
        now_s = self._now_s()
        span_s = round(now_s - self._at_s, _CLOCK_DIGITS)
        if span_s == 0.0:
            return
        self._at_s = now_s
        if span_s < 0.0:
            return  # the clock has gone back: nobody knows how much time has passed
        commanded_s = min(span_s, self._left_s)
        if commanded_s > 0.0:
            self._pass(commanded_s, self._commanded)
        self._left_s = round(self._left_s - commanded_s, _CLOCK_DIGITS)
        idle_s = round(span_s - commanded_s, _CLOCK_DIGITS)
        if idle_s > 0.0:
            self._commanded = self._rest
            self._pass(min(idle_s, self._settles_s), self._rest)

    def _renew(self) -> Reading:
        q, dq, age_s = self._measure()
        sequence = 0 if self._newest is None else self._newest.sequence + 1
        gripper = None if self._gripper is None else self._gripper.measure()
        self._newest = Reading(q, dq, self._at_s - age_s, sequence, gripper, self._external_torque())
        self._read_at_s = self._at_s
        return self._newest


def check_start(robot: Robot, state: FloatArray) -> None:
    """Refuse a start (n,), rad, outside the limits."""
    start = np.array(state, dtype=np.float64)
    if start.shape != (robot.dof,) or not np.isfinite(start).all():
        raise UserError(
            f"An arm with {robot.dof} joints needs {robot.dof} finite joint positions to start from."
        )
    if robot.limits.violation(start).any():
        joint = int(np.argmax(robot.limits.violation(start)))
        raise UserError(
            f"The arm cannot start with {robot.joint_names[joint]} at {start[joint]:.4g}: its limits are"
            f" {robot.limits.lower[joint]:.4g} and {robot.limits.upper[joint]:.4g}."
        )
