"""Whether the newest reading of the arm is new enough to act on."""

import math
from typing import final

from latentarm.core.types import Reading, Stop

_ROUNDING_S = 1e-9  # times that differ by less are the same, s


@final
class NewestReading:
    """Refuses readings that are older than ``timeout_s``, come out of order, or are from the future.

    A reading may be seen more than once while no newer one has come, as long as it is new enough. It may be
    up to ``ahead_s`` newer than its tick: arms go on measuring after the tick has begun.
    """

    def __init__(self, timeout_s: float, ahead_s: float) -> None:
        self._timeout_s = timeout_s + _ROUNDING_S
        self._ahead_s = ahead_s + _ROUNDING_S
        self._sequence: int | None = None
        self.new = False  # whether the reading was not the newest one already the time before

    def reset(self) -> None:
        """Start again: any reading may come next."""
        self._sequence = None

    def refusal(self, reading: Reading, time_s: float) -> Stop | None:
        """Why the reading cannot be used at this time, or None; raises where its figures are no numbers."""
        before = self._sequence
        sequence, age_s = int(reading.sequence), float(time_s - reading.time_s)
        if before is not None and sequence < before:
            return _invalid("The arm's readings came in the wrong order: check its driver.")
        self.new = sequence != before
        self._sequence = sequence
        if not math.isfinite(age_s):
            return _invalid("The arm's newest reading has no time: check its driver.")
        if age_s < -self._ahead_s:
            return _invalid(
                "The arm's newest reading has a time in the future: check its driver and its clock."
            )
        if age_s > self._timeout_s:
            age_ms = round(1000 * age_s)
            return Stop(
                f"The arm's newest reading is {age_ms} ms old: check the connection to the arm.",
                untrusted=True,
                code="reading_old",
                parameters={"age_ms": age_ms},
            )
        return None


def _invalid(reason: str) -> Stop:
    return Stop(reason, untrusted=True, code="reading_invalid")
