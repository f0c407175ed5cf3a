"""What is done with an arm that stands disengaged, besides enabling it."""

from collections.abc import Callable
from typing import Literal, final

from latentarm.arms.contract import Arm
from latentarm.control.engagement import stop_of
from latentarm.control.step import Step
from latentarm.core.types import GripperAsk, Stop
from latentarm.web.arm_process.episodes import Episodes
from latentarm.web.arm_process.hand_guiding import HandGuiding
from latentarm.web.arm_process.lost_arm import LostArm
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import Record
from latentarm.web.protocol.report import Guiding


@final
class Standing:
    """It is guided by hand, or connected again. Neither moves it, nor lets it move.

    Args:
        step: says whether the arm is disengaged.
        arm: what is driven.
        episodes: an episode by hand ends with guiding.
        say: shows people a notice for a while.
    """

    def __init__(self, step: Step, arm: Arm, episodes: Episodes, say: Callable[[Notice], None]) -> None:
        self._step = step
        self._arm = arm
        self._episodes = episodes
        self._say = say
        self._guiding = HandGuiding(arm, step)
        self._connection = LostArm(arm)
        self._phase = arm.status().phase

    @property
    def guiding(self) -> Guiding | None:
        """What a page is told of guiding."""
        return self._guiding.state

    @property
    def guided(self) -> bool:
        """Whether the arm is guided by hand, or is about to be."""
        return self._guiding.under_way

    @property
    def lost(self) -> Notice | None:
        """Why the arm is not connected, or None where it is."""
        return self._connection.reason if self._connection.lost else None

    def begin_guiding(self, time_s: float) -> None:
        """Let the arm be guided, if it is disengaged; an episode under way ends.

        Args:
            time_s: the loop's clock, s.
        """
        if self._step.stopped is None or not self._step.at_rest:
            self._say(Notice(code="stop_first"))
        elif not self._guiding.under_way:
            self._episodes.end()
            self._guiding.begin(time_s)

    def keep_guiding(self, time_s: float, ask: GripperAsk | None) -> None:
        """The page is still there; see `HandGuiding.keep`."""
        self._guiding.keep(time_s, ask)

    def end_guiding(self) -> bool:
        """Let the arm hold still; whether it was guided. An episode by hand ends."""
        if self._episodes.by_hand:
            self._episodes.end()
        return self._guiding.end()

    def records(self, order: Record) -> bool:
        """Whether an episode may begin: one by hand only where the arm is guided."""
        return not order.by_hand or (self._guiding.recordable and self._step.stopped is not None)

    def connect_again(self) -> Literal["under way", "anew"] | None:
        """See `LostArm.connect_again`; None where nothing is lost."""
        if not self._connection.lost:
            return None
        self._say(Notice(code="reconnecting"))
        return self._connection.connect_again()

    def follow(self, time_s: float) -> None:
        """See how guiding goes on, and whether the arm is there.

        Args:
            time_s: the loop's clock, s.
        """
        told = self._guiding.follow(time_s)
        if told is not None:
            self._say(told)
            status = self._arm.status()
            if status.phase in ("off", "fault", "emergency_stop"):
                self._step.refuse(stop_of(status))
        if self._episodes.by_hand and not self._guiding.recordable:
            self._episodes.end()
        self._follow_faults()
        if self._connection.look() == "found" and self._step.stopped is not None:
            self._step.refuse(stop_of(self._arm.status()))
            self._say(Notice(code="reconnected"))

    def _follow_faults(self) -> None:
        """Tell what stops the arm itself, whatever it was stopped for before, and that it may be enabled."""
        if self._step.stopped is None:
            self._phase = "ready"
            return
        status = self._arm.status()
        before, self._phase = self._phase, status.phase
        if status.phase == before:
            return
        if status.phase in ("fault", "emergency_stop"):
            self._step.refuse(stop_of(status))
        elif before == "emergency_stop":
            self._step.refuse(
                Stop("The emergency stop on the arm is released.", code="emergency_stop_released")
            )
