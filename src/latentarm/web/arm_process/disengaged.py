"""Work with a disengaged arm: guiding it by hand, connecting it again."""

from collections.abc import Callable
from typing import final

from latentarm.arms.contract import Arm, ArmStatus
from latentarm.control.engagement import stop_of
from latentarm.control.step import Step
from latentarm.core.types import Stop
from latentarm.web.arm_process.episodes import Episodes
from latentarm.web.arm_process.hand_guiding import HandGuiding, why_not
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import Record


@final
class Disengaged:
    """Guides the arm by hand, or connects it again; neither moves it or enables it."""

    def __init__(self, step: Step, arm: Arm, episodes: Episodes, say: Callable[[Notice], None]) -> None:
        self._step = step
        self._arm = arm
        self._episodes = episodes
        self._say = say
        self.guiding = HandGuiding(arm, step)
        self._lost = _is_lost(arm.status())
        self._phase = arm.status().phase

    @property
    def lost(self) -> Notice | None:
        """Why the arm is not connected, or why the last attempt failed; None if it is connected."""
        return why_not(self._arm.status()) if self._lost else None

    def begin_guiding(self, time_s: float) -> None:
        """Begin guiding, at the loop's time, s, if the arm is disengaged; an episode under way ends."""
        if self._step.stopped is None or not self._step.at_rest:
            self._say(Notice(code="stop_first"))
        elif not self.guiding.under_way:
            self._episodes.end()
            self.guiding.begin(time_s)

    def end_guiding(self) -> bool:
        """Let the arm hold still; an episode by hand ends. Returns whether it was guided."""
        if self._episodes.by_hand:
            self._episodes.end()
        return self.guiding.end()

    def records(self, order: Record) -> bool:
        """Whether an episode may begin: one by hand only while the arm is guided."""
        return not order.by_hand or (self.guiding.recordable and self._step.stopped is not None)

    def connect_again(self) -> bool:
        """Renew a lost connection; the arm is disabled afterwards.

        Returns whether the arm's driver cannot do so without waiting: `reconnect` does.
        """
        if not self._lost:
            return False
        self._say(Notice(code="reconnecting"))
        recoverable = self._arm.status().recoverable
        if recoverable:
            self._arm.recover()
        return not recoverable

    def follow(self, time_s: float) -> None:
        """Follow guiding and the connection at the loop's time, s."""
        told = self.guiding.follow(time_s)
        if told is not None:
            self._say(told)
            status = self._arm.status()
            if status.phase in ("off", "fault", "emergency_stop"):
                self._step.refuse(stop_of(status))
        if self._episodes.by_hand and not self.guiding.recordable:
            self._episodes.end()
        self._follow_faults()
        status = self._arm.status()
        was_lost, self._lost = self._lost, _is_lost(status)
        if was_lost and not self._lost and self._step.stopped is not None:
            self._step.refuse(stop_of(status))
            self._say(Notice(code="reconnected"))

    def _follow_faults(self) -> None:
        """Report faults of a stopped arm, whatever stopped it, and when the emergency stop is released."""
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


def _is_lost(status: ArmStatus) -> bool:
    return status.lost or status.phase == "off"
