"""Keeps joints within their speed limits."""

from typing import final

import numpy as np

from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.small import largest, smallest
from latentarm.types import FloatArray


@final
class JointVelocity(SafetyFilter):
    """Slows the whole arm down until its fastest joint is within the limit; the direction is kept."""

    @property
    def name(self) -> str:
        """See the base class."""
        return "joint velocity"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        """See the base class."""
        speed, limit = np.abs(velocity), situation.bounds.speed
        if largest(speed) <= situation.bounds.slowest:
            return velocity
        # Written so that nothing overflows, neither at 1e308 nor at zero.
        share = smallest(limit / np.maximum(speed, limit))
        return velocity if share == 1.0 else velocity * share
