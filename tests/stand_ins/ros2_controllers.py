"""An arm and a gripper under controllers that behave as those of ros2_control."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

LAG_S: Final = 0.01
"""The hardware's velocity follows its command with this time constant, s."""

STEP_S: Final = 0.002
"""A trajectory is followed in steps of this length, s."""


class SimulatedController:
    """An arm under one controller, advanced by a clock.

    A velocity controller goes on with its last command for ever. A trajectory controller ends where its last
    trajectory ended. A controller that is deactivated stops the hardware, and forgets what it was told. While
    the emergency stop is pressed the hardware stands still, and afterwards obeys the controller again.

    Args:
        q: (n,), where it starts, rad.
        lower: (n,), rad.
        upper: (n,), rad.
        now_s: the time, s.
    """

    def __init__(self, q: FloatArray, lower: FloatArray, upper: FloatArray, now_s: float) -> None:
        self.q = np.array(q, dtype=np.float64)
        self.dq = np.zeros_like(self.q)
        self.active = True
        self.stop_pressed = False
        self._lower, self._upper = lower, upper
        self._at_s = now_s
        self._velocity: FloatArray | None = None
        self._knots: list[tuple[float, FloatArray, FloatArray]] = []

    def command(self, velocity: Sequence[float], now_s: float) -> None:
        """What ``forward_command_controller`` does with a message."""
        self.advance(now_s)
        if self.active and len(velocity) == len(self.q) and np.isfinite(velocity).all():
            self._velocity = np.array(velocity)

    def follow(self, points: Sequence[tuple[FloatArray, FloatArray, float]], now_s: float) -> None:
        """What ``joint_trajectory_controller`` does with a message: positions, velocities, s from now."""
        self.advance(now_s)
        if not self.active or np.abs(points[-1][1]).max() > 0.0:
            return
        desired, speed = self._desired(now_s)
        self._knots = [(now_s, desired, speed)]
        self._knots += [(now_s + after_s, np.array(q), np.array(dq)) for q, dq, after_s in points]

    def switch(self, *, active: bool, now_s: float) -> None:
        """Activate or deactivate the controller."""
        self.advance(now_s)
        self.active, self._velocity, self._knots = active, None, []

    def advance(self, now_s: float) -> None:
        """Let time pass."""
        while self._at_s < now_s:
            span_s = min(STEP_S if self._knots else math.inf, now_s - self._at_s)
            self._at_s += span_s
            wanted = np.zeros_like(self.q) if self._velocity is None else self._velocity
            if self._knots:
                wanted = (self._desired(self._at_s)[0] - self.q) / LAG_S
            if self.stop_pressed or not self.active:
                wanted = np.zeros_like(self.q)
            decay = math.exp(-span_s / LAG_S)
            moved = self.q + wanted * span_s + (self.dq - wanted) * LAG_S * (1.0 - decay)
            self.dq = wanted + (self.dq - wanted) * decay
            self.q = np.clip(moved, self._lower, self._upper)
            self.dq[self.q != moved] = 0.0

    def _desired(self, now_s: float) -> tuple[FloatArray, FloatArray]:
        """Cubic between the points, as the controller does it."""
        if not self._knots:
            return self.q.copy(), np.zeros_like(self.q)
        for (t0, q0, v0), (t1, q1, v1) in zip(self._knots, self._knots[1:], strict=False):
            if now_s < t1:
                h, s = t1 - t0, (now_s - t0) / (t1 - t0)
                a, b = h * v0 + h * v1 - 2 * (q1 - q0), 3 * (q1 - q0) - 2 * h * v0 - h * v1
                return q0 + h * v0 * s + b * s**2 + a * s**3, (h * v0 + 2 * b * s + 3 * a * s**2) / h
        return self._knots[-1][1], np.zeros_like(self.q)


class SimulatedGripper:
    """A gripper under a ``GripperCommand`` action: it moves, stalls at a thing, or reaches its goal.

    Attributes:
        thing_m: fingers stop at this opening; None where nothing is between them.
    """

    def __init__(self, opening_m: float, speed_m_s: float, now_s: float) -> None:
        self.opening_m = self.goal_m = opening_m
        self.thing_m: float | None = None
        self._speed_m_s, self._at_s = speed_m_s, now_s

    def advance(self, now_s: float) -> None:
        """Let time pass."""
        most = self._speed_m_s * (now_s - self._at_s)
        self._at_s = now_s
        to_m = self.goal_m if self.thing_m is None else max(self.goal_m, self.thing_m)
        self.opening_m += float(np.clip(to_m - self.opening_m, -most, most))

    @property
    def reached(self) -> bool:
        """Whether it is at its goal."""
        return abs(self.opening_m - self.goal_m) < 1e-4

    @property
    def stalled(self) -> bool:
        """Whether a thing keeps it from its goal."""
        return not self.reached and self.thing_m is not None and abs(self.opening_m - self.thing_m) < 1e-4
