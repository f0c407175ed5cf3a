"""Converts the times of the controller's reports to our clock."""

from typing import Final, final

_DRIFT: Final = 2e-4  # largest relative drift between the clocks
_AHEAD_S: Final = 0.05  # a report that arrives this long before its measurement shows that a clock jumped
_BEHIND_S: Final = 0.5  # no report is so late without a fault
_OWN_JUMP_S: Final = 0.05


@final
class ReportClock:
    """Converts the controller's times, and finds clocks that jump; ``fault`` is one sentence, or "".

    The quickest report so far gives the least travel time; any further delay counts as the report's age. This
    reveals reports that were held up on the way.
    """

    def __init__(self) -> None:
        self.fault = ""
        self._quickest_s: float | None = None
        self._before: tuple[float, float] | None = None

    def measured_s(self, arrived_s: float, monotonic_s: float, controller_s: float | None) -> float:
        """Time of measurement on the driver's clock, s; without ``controller_s`` that of arrival."""
        elapsed_s = 0.0
        if self._before is not None:
            elapsed_s = monotonic_s - self._before[1]
            jumped_s = (arrived_s - self._before[0]) - elapsed_s
            if abs(jumped_s) > _OWN_JUMP_S:
                self._found(f"This computer's clock has jumped by {jumped_s:.2g} s")
        self._before = arrived_s, monotonic_s
        if controller_s is None:
            return arrived_s
        took_s = monotonic_s - controller_s
        if self._quickest_s is None:
            self._quickest_s = took_s
        late_s = took_s - (self._quickest_s + _DRIFT * elapsed_s)
        if late_s < -_AHEAD_S:
            self._found(f"The clock of the arm's controller has jumped forward by {-late_s:.2g} s")
        elif late_s > _BEHIND_S:
            self._found(
                f"The clock of the arm's controller has jumped back, or its reports are {late_s:.2g} s late"
            )
        self._quickest_s = min(self._quickest_s + _DRIFT * elapsed_s, took_s)
        return arrived_s - max(0.0, late_s)

    def _found(self, what: str) -> None:
        if not self.fault:
            self.fault = (
                f"{what}: check that nothing sets it while the arm is in use, then enable the arm again."
            )
