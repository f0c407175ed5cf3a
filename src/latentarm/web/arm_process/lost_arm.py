"""A connection to the arm that is lost, and made again when a person asks for it. Nothing moves for it."""

from typing import Literal, final

from latentarm.arms.contract import Arm, ArmStatus
from latentarm.control.engagement import stop_of
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.protocol.notice import Notice, notice_of_stop


@final
class LostArm:
    """Watches the connection.

    Args:
        arm: what is driven.

    Attributes:
        lost: whether the connection is lost.
    """

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self.lost = _lost(arm.status())

    def look(self) -> Literal["lost", "found"] | None:
        """What has become of it since it was looked at last; None where that is the same as before."""
        before, self.lost = self.lost, _lost(self._arm.status())
        if before == self.lost:
            return None
        return "lost" if self.lost else "found"

    @property
    def reason(self) -> Notice:
        """Why it is lost, or why the last try failed."""
        return why_not(self._arm.status())

    def connect_again(self) -> Literal["under way", "anew"]:
        """Ask the driver for a new connection; the arm is disabled afterwards.

        Returns:
            *anew* where its driver cannot do so without waiting: `reconnect` does.
        """
        if not self._arm.status().recoverable:
            return "anew"
        self._arm.recover()
        return "under way"


def reconnect(arm: Arm) -> None:
    """Close the connection and open it again, which waits for the arm.

    Raises:
        UserError: the arm does not answer, or is refused.
    """
    arm.close()
    arm.connect()


def why_not(status: ArmStatus) -> Notice:
    """Why an arm takes no commands: its connection is lost, or what its driver says."""
    if status.lost:
        return Notice(code="arm_lost", parameters={"text": one_line(status.reason)})
    return notice_of_stop(stop_of(status))


def _lost(status: ArmStatus) -> bool:
    return status.lost or status.phase == "off"
