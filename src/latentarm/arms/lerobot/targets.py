"""Position targets from velocities of bounded duration, for servos that only know positions."""

import math
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray

LONGEST_STEP_S: Final = 0.02  # targets move no longer than this in a late step
LEAD_RAD: Final = 0.15  # largest lead of a target over a joint that is held up
STOP_LEAD_RAD: Final = 0.03  # largest lead once the arm is stopped


@final
class Targets:
    """Integrates commanded velocities, (n,), rad/s, into targets within limits, (n,), rad.

    Without a command in force the targets stand still, so the arm does. A target does not leave the limits,
    but one outside may return.
    """

    def __init__(self, lower: FloatArray, upper: FloatArray, speed: FloatArray) -> None:
        self._lower, self._upper, self._speed = lower, upper, speed
        self._velocity = np.zeros(len(lower))
        self._target = np.zeros(len(lower))
        self._from_s = self._until_s = -math.inf

    def begin(self, q: FloatArray) -> None:
        """Stand still at the arm's position, (n,), rad."""
        self._target = np.array(q)
        self._until_s = -math.inf

    def command(self, velocity: FloatArray, from_s: float, until_s: float) -> None:
        """Move at a velocity (n,), rad/s, from the time of sending until the command runs out."""
        if self._until_s < from_s:  # it moves from rest; else this velocity follows the one before
            self._from_s = max(self._from_s, from_s)
        self._velocity = np.clip(velocity, -self._speed, self._speed)
        self._until_s = until_s

    def halt(self, q: FloatArray) -> None:
        """Forget the command, and keep only a small lead over the arm's position, (n,), rad."""
        self._until_s = -math.inf
        self._target = q + np.clip(self._target - q, -STOP_LEAD_RAD, STOP_LEAD_RAD)

    def moving(self, now_s: float) -> bool:
        """Whether a command in force moves the arm."""
        return now_s < self._until_s and bool(self._velocity.any())

    def advance(self, now_s: float, q: FloatArray) -> FloatArray:
        """The present targets, (n,), rad, with the arm at q, (n,), rad."""
        ends_s = min(now_s, self._until_s)
        span_s = min(ends_s - self._from_s, LONGEST_STEP_S) if ends_s > self._from_s else 0.0
        self._from_s = max(now_s, self._from_s)
        wanted = self._target + self._velocity * span_s
        held_up = (np.abs(wanted - q) > LEAD_RAD) & (np.abs(wanted - q) > np.abs(self._target - q))
        outward = (wanted > self._upper) & (wanted > self._target)
        outward |= (wanted < self._lower) & (wanted < self._target)
        inside = np.clip(wanted, np.minimum(self._lower, self._target), np.maximum(self._upper, self._target))
        self._target = np.where(held_up, self._target, np.where(outward, inside, wanted))
        return self._target.copy()
