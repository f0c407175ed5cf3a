"""Keeps every point of the arm within the speed limit."""

from typing import final

import numpy as np

from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.small import largest
from latentarm.types import FloatArray

HEADROOM = 0.95
"""Shaping aims for this share of the limit: the rest is for what turning links add before the next tick."""


@final
class LinkSpeed(SafetyFilter):
    """Slows the whole arm down until no point on any link, nor the tool, is too fast."""

    @property
    def name(self) -> str:
        """See the base class."""
        return "link speed"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        """See the base class."""
        limit = HEADROOM * situation.bounds.config.link_speed
        nearby, drift = situation.nearby()
        bend = nearby.body.bent(drift) @ np.abs(velocity)
        if largest(nearby.speeds(velocity) + bend) <= limit:
            return velocity
        fastest = largest(situation.placement.speeds(velocity))
        return velocity if fastest <= limit else velocity * (limit / fastest)
