"""Guiding an arm by hand, while the page of the person who asked for it is connected."""

import math
from typing import Final, Literal, final

from latentarm.arms.contract import Arm, ArmStatus
from latentarm.arms.real import GuidableArm
from latentarm.control.engagement import stop_of
from latentarm.control.loop import ENABLING_S
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import GripperAsk
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.protocol.notice import Notice, notice_of, notice_of_stop
from latentarm.web.protocol.report import Guiding

PAGE_S: Final = 1.0
"""Guiding ends when the page has been silent for so long, s; it speaks five times as often."""


@final
class HandGuiding:
    """Begins and ends guiding. The arm's loop goes on, disengaged, and moves the gripper on request."""

    def __init__(self, arm: Arm, step: Step) -> None:
        self._arm = arm if isinstance(arm, GuidableArm) else None
        self._step = step
        self._doing: Literal["nothing", "asking", "guiding"] = "nothing"
        self._told = False
        self._own_mode = False
        self._ask: GripperAsk | None = None
        self._since_s = self._heard_s = -math.inf

    @property
    def state(self) -> Guiding | None:
        """The state for pages; None if the arm cannot be guided."""
        if self._arm is None:
            return None
        if self._doing == "guiding":
            return "on"
        return "own" if self._own_mode else "offered"

    @property
    def under_way(self) -> bool:
        """Whether the arm is guided, or is about to be."""
        return self._doing != "nothing"

    @property
    def recordable(self) -> bool:
        """Whether a motion by hand can be recorded: the arm is guided, or may be in a mode of its own."""
        return self.state in ("on", "own")

    def begin(self, time_s: float) -> None:
        """Ask the arm for it at the loop's time, s; ignored if it cannot be guided, or is already."""
        if self._arm is not None and self._doing == "nothing":
            self._doing, self._told = "asking", False
            self._since_s = self._heard_s = time_s

    def keep(self, time_s: float, ask: GripperAsk | None) -> None:
        """Note that the page is still there, at the loop's time, s, and what it asks of the gripper."""
        self._heard_s = time_s
        if ask is not None and self._doing == "guiding":
            self._ask = ask

    def end(self) -> bool:
        """Let the arm hold its position; returns whether guiding was under way."""
        if self._arm is None or self._doing == "nothing":
            return False
        self._doing, self._ask = "nothing", None
        self._arm.disable()
        return True

    def follow(self, time_s: float) -> Notice | None:
        """Advance to the loop's time, s, or end it with the arm or the page; returns a notice for people."""
        if self._arm is None or self._doing == "nothing":
            return None
        if time_s - self._heard_s > PAGE_S:
            self.end()
            return Notice(code="guiding_page_gone")
        status = self._arm.status()
        if status.phase == "guided" and self._told:
            self._doing = "guiding"
            self._step.guided(self._ask)
            self._ask = None
            return None
        if self._doing == "asking" and time_s - self._since_s <= ENABLING_S:
            return self._ask_for_it(self._arm)
        self.end()
        return Notice(code="guiding_ended") if status.phase == "disabled" else why_not(status)

    def _ask_for_it(self, arm: GuidableArm) -> Notice | None:
        """Disable the arm if it takes commands; ask it once it is disabled."""
        status = arm.status()
        if status.takes_commands:
            arm.disable()
        elif status.phase == "fault" and status.recoverable:
            arm.recover()
        elif status.phase == "disabled":
            self._told = True
            try:
                arm.guide()
            except UserError as error:
                self._doing, self._own_mode = "nothing", True
                return notice_of(error)
        elif status.phase != "guided":  # from before: it comes to rest first
            self._doing = "nothing"
            return why_not(status)
        return None


def why_not(status: ArmStatus) -> Notice:
    """Why an arm takes no commands: its connection is lost, or its driver's reason."""
    if status.lost:
        return Notice(code="arm_lost", parameters={"text": one_line(status.reason)})
    return notice_of_stop(stop_of(status))
