"""The stopping manoeuvre that every command is checked against."""

import math
from typing import final

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig, Trajectory

from latentarm.core.types import FloatArray
from latentarm.safety.small import any_nonzero, largest

AT_REST_S = 1e-9  # a brake shorter than this is, in float64, indistinguishable from standing still


@final
class Brake:
    """From a velocity and an acceleration to rest, on a straight line in joint space.

    First every joint's acceleration goes to zero at the stopping jerk (a millisecond or so, phase one);
    that leaves the velocity ``v+ = v + a |a| / (2 j)``. Then all joints slow down in proportion,
    ``v(t) = sigma(t) v+`` with one jerk-limited ramp ``sigma`` from 1 to 0 (phase two). So the path is
    straight, whatever the pace along it, and checking the line is checking the manoeuvre. The
    commands sampled from it never pass its end either: sigma only falls.

    ``sigma`` has plateau deceleration ``rate = min(min_i A_i / |v+_i|, sqrt(B))`` with
    ``B = min_i J_i / |v+_i|``, lasts ``1 / rate + rate / B`` and covers half of that time at full speed.

    Its arguments are (n,): velocity, rad/s, and acceleration, rad/s²; the stop's A, rad/s², and J, rad/s³.
    """

    __slots__ = (
        "_acceleration",
        "_fall",
        "_stop_jerk",
        "_velocity",
        "kink",
        "onset_s",
        "ramp_s",
        "rate",
        "settle_s",
        "settled",
    )

    def __init__(
        self,
        velocity: FloatArray,
        acceleration: FloatArray,
        stop_acceleration: FloatArray,
        stop_jerk: FloatArray,
    ) -> None:
        self._velocity, self._acceleration, self._stop_jerk = velocity, acceleration, stop_jerk
        self._fall: _Fall | None = None
        if any_nonzero(acceleration):
            settle = np.abs(acceleration) / stop_jerk
            self.settle_s = largest(settle)  # duration of phase one, s
            self.kink = 0.5 * acceleration * settle  # (n,), ``v+ - v``, rad/s
            self.settled = velocity + self.kink  # (n,), ``v+``, rad/s
        else:
            self.settle_s, self.kink, self.settled = 0.0, acceleration, velocity
        speed = np.abs(self.settled)
        by_acceleration = largest(speed / stop_acceleration)
        if by_acceleration < AT_REST_S:
            self.rate, self.onset_s, self.ramp_s = math.inf, 0.0, 0.0
            return
        by_jerk = largest(speed / stop_jerk)
        # Plateau deceleration of sigma, 1/s; infinite where ``v+`` is zero
        self.rate = min(1.0 / by_acceleration, math.sqrt(1.0 / by_jerk))
        self.onset_s = self.rate * by_jerk  # time that phase two takes to reach its plateau, s
        self.ramp_s = 1.0 / self.rate + self.onset_s  # duration of phase two, s

    @property
    def duration_s(self) -> float:
        """Time to rest, s."""
        return self.settle_s + self.ramp_s

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray]:
        """Velocity (n,), rad/s, and acceleration (n,), rad/s², at a time after the brake began."""
        if time_s >= self.duration_s:
            return np.zeros_like(self._velocity), np.zeros_like(self._velocity)
        if time_s < self.settle_s:
            jerk = -np.sign(self._acceleration) * self._stop_jerk
            since = np.minimum(time_s, np.abs(self._acceleration) / self._stop_jerk)
            velocity = self._velocity + (self._acceleration + 0.5 * jerk * since) * since
            return velocity, self._acceleration + jerk * since
        if self._fall is None:
            # Computed when first needed: most brakes are only checked.
            self._fall = _Fall(1.0 / (self.rate * self.onset_s))
        sigma, slope = self._fall.at((time_s - self.settle_s) * self.rate)
        return sigma * self.settled, slope * self.rate * self.settled


@final
class _Fall:
    """The ramp sigma from 1 to 0, at a plateau of -1 per unit of time.

    Time is in units of the ramp's own length, because Ruckig is inaccurate for the decelerations of many
    thousands per second that an almost motionless arm would need. ``jerk`` is at least 1.
    """

    __slots__ = ("_trajectory",)

    def __init__(self, jerk: float) -> None:
        wanted = InputParameter(1)
        wanted.control_interface = ControlInterface.Velocity
        wanted.current_velocity = [1.0]
        wanted.target_velocity = [0.0]
        wanted.max_acceleration = [1.0]
        wanted.max_jerk = [jerk]
        self._trajectory = Trajectory(1)
        result = Ruckig(1).calculate(wanted, self._trajectory)
        if result not in (Result.Working, Result.Finished):
            raise ArithmeticError(f"no stopping ramp with a jerk of {jerk:g}: {result}")

    def at(self, time: float) -> tuple[float, float]:
        """Sigma and its slope, in units of the ramp, since it began."""
        _, sigma, slope = self._trajectory.at_time(time)
        return sigma[0], slope[0]
