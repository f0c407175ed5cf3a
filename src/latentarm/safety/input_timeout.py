"""The filter that stops an arm whose newest input is too old."""

from typing import final

from typing_extensions import override

from latentarm.core.types import FloatArray, Stop
from latentarm.safety.filter import SafetyFilter, Situation


@final
class InputTimeout(SafetyFilter):
    """Stops where the newest input is too old (or its age is not a number).

    The stop is ramped. To continue, the person releases the stick and enables the arm again, so that the arm
    never starts to move by surprise when a connection returns.
    """

    name = "freshness"

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        return self.refusal(situation.input_age_s, situation.bounds.config.input_timeout_s) or velocity

    @staticmethod
    def refusal(age_s: float, timeout_s: float) -> Stop | None:
        """Why an input of this age may not move the arm, or None."""
        if 0.0 <= age_s <= timeout_s:
            return None
        if age_s > timeout_s:
            return Stop(f"No input came for more than {1000 * timeout_s:.0f} ms.", code="input_late")
        return Stop("The input's age is not known.", code="input_invalid")
