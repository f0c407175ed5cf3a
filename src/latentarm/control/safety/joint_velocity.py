"""No joint faster than allowed."""

from typing import final

import numpy as np

from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.small import largest
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
        limit = situation.bounds.speed
        fastest = largest(np.abs(velocity))
        # limit / fastest first: fastest may be 1e308
        return velocity if fastest <= limit else velocity * (limit / fastest)
