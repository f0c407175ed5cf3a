"""An arm without inertia: it does what it is told, and stops by itself when told nothing more."""

from typing import final

import numpy as np

from latentarm.arms.contract import SimulatedArm
from latentarm.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.types import Command, FloatArray


@final
class KinematicArm(SimulatedArm):
    """Kinematic simulation of the paper's transition, ``s' = s + a dt``.

    A joint that reaches a limit stays there, as at a hard stop.

    Args:
        robot: whose joints these are.
        state: (n,), where the arm starts, rad.

    Raises:
        UserError: ``state`` has the wrong shape, is not finite, or lies outside the limits.
    """

    def __init__(self, robot: Robot, state: FloatArray) -> None:
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
        self._limits = robot.limits
        self._state = start
        self._velocity = np.zeros(robot.dof)
        self._left_s = 0.0

    def state(self) -> FloatArray:
        """(n,), joint positions, rad."""
        return self._state.copy()

    def velocity(self) -> FloatArray:
        """(n,), joint velocities, rad/s; zero once the last command has run out."""
        return self._velocity.copy()

    def send(self, command: Command) -> None:
        """Take a command; it replaces the one before.

        Raises:
            ValueError: the velocity has the wrong shape or is not finite: no safety filter sends that.
        """
        velocity = np.array(command.velocity, dtype=np.float64)
        if velocity.shape != self._state.shape or not np.isfinite(velocity).all():
            raise ValueError(f"a command needs {len(self._state)} finite joint velocities")
        self._velocity = velocity
        self._left_s = max(float(command.duration_s), 0.0)

    def stop(self) -> None:
        """Stop now and forget the last command."""
        self._velocity = np.zeros_like(self._velocity)
        self._left_s = 0.0

    def advance(self, dt_s: float) -> None:
        """Let time pass; see the base class."""
        if not (np.isfinite(dt_s) and dt_s > 0.0):
            raise UserError(f"The simulated arm's time step is {dt_s} s: it must be above zero.")
        moving = min(dt_s, self._left_s)
        moved = self._state + self._velocity * moving
        self._state = np.clip(moved, self._limits.lower, self._limits.upper)
        self._left_s -= dt_s
        # A hair of rounding must not stop an arm whose commands last exactly one step.
        if self._left_s <= -1e-9:
            self.stop()
        else:
            self._velocity = np.where(moved == self._state, self._velocity, 0.0)
            self._left_s = max(self._left_s, 0.0)
