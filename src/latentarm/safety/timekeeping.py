"""Whether the loop's clock can be trusted."""

from typing import final

from latentarm.core.types import Stop


@final
class Timekeeping:
    """Notices a clock that stands still, goes back, or jumps farther than one command lasts.

    After any of these the elapsed time is unknown, and so is whether the arm still moves or has stopped by
    itself. A command that continues from the last one could then be a jump.

    One command lasts ``hold_s``.
    """

    def __init__(self, hold_s: float) -> None:
        # A tick exactly at the end of a command must not count as late because of rounding.
        self._hold_s = hold_s + 1e-9
        self._tick_s: float | None = None
        self._sent_s = 0.0

    def reset(self) -> None:
        """Start again: any time may come next."""
        self._tick_s = None

    def sent(self, time_s: float) -> None:
        """Set when the command was sent, s; by default that is the tick's own time."""
        self._sent_s = time_s

    def refusal(self, time_s: float) -> Stop | None:
        """Why no command may follow at this time of the loop's clock, s, or None."""
        before_s, sent_s = self._tick_s, self._sent_s
        self._tick_s = self._sent_s = time_s
        if before_s is None:
            return None
        # Written so that a time that is not a number fails too.
        if not time_s > before_s:
            return Stop(
                "The computer's clock stood still or went back: the arm was stopped.",
                code="clock_stood_still",
            )
        if not time_s - sent_s <= self._hold_s:
            return Stop(
                "The computer's clock jumped, or the computer slept: the arm has stopped by itself.",
                code="clock_jumped",
            )
        return None
