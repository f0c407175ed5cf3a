"""Whether the arm may move: it starts disengaged, and every stop disengages it again."""

from typing import final

from latentarm.types import Stop


@final
class Engagement:
    """Motion needs a neutral input first and then an explicit action, at the start and after any stop."""

    def __init__(self) -> None:
        self._stopped: Stop | None = Stop("The arm is not enabled yet.")
        self._neutral = False

    @property
    def stopped(self) -> Stop | None:
        """Why the arm may not move, or None where it may."""
        return self._stopped

    def stop(self, stop: Stop) -> None:
        """Disengage. The first reason is kept until the arm is enabled again.

        A stick that was let go before the stop does not count: neutral must be seen after it.
        """
        self._neutral = False
        if self._stopped is None:
            self._stopped = stop

    def replace(self, stop: Stop) -> None:
        """Disengage for a reason that people must hear of, whatever the arm was stopped for before."""
        self._neutral = False
        self._stopped = stop

    def saw(self, neutral: bool) -> None:
        """Take note of a fresh, valid input: was it neutral?"""
        self._neutral = neutral

    def enable(self) -> Stop | None:
        """Engage, where the newest input is neutral.

        Returns:
            None where the arm is engaged now, else why it is not.
        """
        if self._stopped is None:
            return None
        if not self._neutral:
            return Stop("Let go of the stick first, then enable the arm.")
        self._stopped = None
        return None
