"""A lost connection to the arm, and its renewal on request. Nothing moves for it."""

from typing import Literal, final

from latentarm.arms.contract import Arm, ArmStatus
from latentarm.control.arm_stops import stop_of
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.protocol.notice import Notice, notice_of_stop


@final
class LostArm:
    """Watches the connection."""

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self.lost = _lost(arm.status())

    def look(self) -> Literal["lost", "found"] | None:
        """The change since the last call; None for none."""
        before, self.lost = self.lost, _lost(self._arm.status())
        if before == self.lost:
            return None
        return "lost" if self.lost else "found"

    @property
    def reason(self) -> Notice:
        """Why it is lost, or why the last attempt failed."""
        return why_not(self._arm.status())

    def connect_again(self) -> Literal["under way", "anew"]:
        """Ask the driver for a new connection; the arm is disabled afterwards.

        Returns:
            *anew* if its driver would have to wait: `reconnect` does.
        """
        if not self._arm.status().recoverable:
            return "anew"
        self._arm.recover()
        return "under way"


def reconnect(arm: Arm) -> None:
    """Close the connection and open it again, waiting for the arm.

    Raises:
        UserError: the arm does not answer, or is refused.
    """
    arm.close()
    arm.connect()


def why_not(status: ArmStatus) -> Notice:
    """Why an arm takes no commands: its connection is lost, or its driver's reason."""
    if status.lost:
        return Notice(code="arm_lost", parameters={"text": one_line(status.reason)})
    return notice_of_stop(stop_of(status))


def _lost(status: ArmStatus) -> bool:
    return status.lost or status.phase == "off"
