"""Numbers only."""

import math
from typing import final

from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.types import FloatArray, Stop


@final
class Finite(SafetyFilter):
    """Stops where a velocity is not a number, not finite, or not one for each joint."""

    @property
    def name(self) -> str:
        """See the base class."""
        return "finite"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        """See the base class."""
        if velocity.shape != situation.state.shape:
            return Stop(f"The controller gave {velocity.shape} numbers for {len(situation.state)} joints.")
        if not all(map(math.isfinite, velocity.tolist())):
            return Stop("The controller gave a velocity that is not a finite number.")
        return velocity
