"""Whether the arm may move: it starts disengaged, and every stop disengages it again."""

from typing import Final, final

from latentarm.arms.contract import ArmPhase, ArmStatus
from latentarm.core.types import Stop, StopCode

_CODES: Final[dict[ArmPhase, StopCode]] = {
    "off": "arm_off",
    "disabled": "not_enabled",
    "fault": "arm_fault",
    "emergency_stop": "arm_emergency_stop",
}


def stop_of(status: ArmStatus) -> Stop:
    """Why an arm that takes no commands may not move."""
    text = {"text": status.reason} if status.phase == "fault" else {}
    return Stop(status.reason, code=_CODES.get(status.phase), parameters=text)


@final
class Engagement:
    """Motion needs a neutral input first and then an explicit action, at the start and after any stop."""

    def __init__(self) -> None:
        self._stopped: Stop | None = Stop("The arm is not enabled yet.", code="not_enabled")
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
        """Disengage, and replace any earlier reason: this one must be shown."""
        self._neutral = False
        self._stopped = stop

    def saw(self, neutral: bool) -> None:
        """Record whether a fresh, valid input was neutral."""
        self._neutral = neutral

    def enable(self) -> Stop | None:
        """Engage if the newest input is neutral; why not, or None."""
        if self._stopped is None:
            return None
        if not self._neutral:
            return Stop("Let go of the stick first, then enable the arm.", code="let_go_first")
        self._stopped = None
        return None
