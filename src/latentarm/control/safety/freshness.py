"""Stops the arm when inputs are stale."""

from typing import final

from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.types import FloatArray, Stop


@final
class Freshness(SafetyFilter):
    """Stops where the newest input is too old (or its age is not a number).

    The stop is ramped. To continue, the person releases the stick and enables the arm again, so that the arm
    never starts to move by surprise when a connection returns.
    """

    @property
    def name(self) -> str:
        """See the base class."""
        return "freshness"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        """See the base class."""
        return self.refusal(situation.input_age_s, situation.bounds.config.input_timeout_s) or velocity

    @staticmethod
    def refusal(age_s: float, timeout_s: float) -> Stop | None:
        """Why an input of this age may not move the arm, or None."""
        if 0.0 <= age_s <= timeout_s:
            return None
        if age_s > timeout_s:
            return Stop(f"No input came for more than {1000 * timeout_s:.0f} ms.", code="input_late")
        return Stop("The input's age is not known.")
