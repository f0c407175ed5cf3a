"""The asking process's side of `latentarm_process`."""

import math
from dataclasses import dataclass
from typing import Any, Final, final

from latentarm.arms.helper_process import HelperProcess
from latentarm.control.clock import MonotonicClock
from latentarm.control.loop import ENABLING_S
from latentarm.core.errors import UserError
from latentarm.core.types import GripperAsk
from latentarm_process.driven import Wanted

_LOADING_S: Final = 120.0
"""A run, its robot and the arm are loaded and connected within this time, s."""

_ANSWER_S: Final = 1.0
"""A process that has not answered for so long is given up, s."""

_ENDING_S: Final = 5.0
"""The arm is brought to rest within this time, s."""


@final
@dataclass(frozen=True)
class Seen:
    """What the driving process sees at one moment.

    Attributes:
        q: joint positions, rad; NaN where they cannot be read.
        tool: position, m, and quaternion (w, x, y, z) of the tool in the base frame.
        width_m: opening of the gripper, m; None without one.
        u: the input as it was used.
        stopped: why the arm may not move, or "" where it may.
        ticks: of the loop so far.
        met_share: share of these that were done in time.
    """

    q: tuple[float, ...]
    tool: tuple[float, ...]
    width_m: float | None
    u: tuple[float, ...]
    stopped: str
    ticks: int
    met_share: float


@final
class DrivingProcess:
    """A running process that drives an arm; the arm is enabled.

    Args:
        wanted: what is driven.

    Raises:
        UserError: it cannot be driven, or the arm does not become ready.
    """

    def __init__(self, wanted: Wanted) -> None:
        self._clock = MonotonicClock()
        self._looks = 0
        self._process = HelperProcess("latentarm_process")
        try:
            self._begin(wanted)
        except BaseException:
            self._process.end(_ENDING_S)
            raise

    def _begin(self, wanted: Wanted) -> None:
        self._process.port.send(wanted.message())
        answer = self._answer(_LOADING_S)
        if "refused" in answer:
            raise UserError(answer["refused"])
        until_s = self._clock.now_s() + ENABLING_S + _ANSWER_S
        while stopped := self.look().stopped:
            if self._clock.now_s() > until_s:
                raise UserError(f"The arm cannot be enabled: {stopped}")

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._process.alive

    def drive(self, u: list[float], gripper: GripperAsk | None) -> None:
        """Hand over an action; the newest one counts, and no longer than its time.

        Args:
            u: d numbers, each in [-1, 1].
            gripper: what is asked of the gripper now.
        """
        self._process.port.send({"u": u, "gripper": gripper, "sent_s": self._clock.now_s()})

    def look(self) -> Seen:
        """What the process saw in its newest tick, at most a period ago.

        Raises:
            UserError: it does not answer, or is gone.
        """
        self._looks += 1
        self._process.port.send({"look": self._looks})
        answer: dict[str, Any] = {}
        while answer.pop("seen", None) != self._looks:
            answer = self._answer(_ANSWER_S)
        width_m = answer["width_m"]
        return Seen(
            q=tuple(math.nan if one is None else float(one) for one in answer["q"]),
            tool=tuple(answer["tool"]),
            width_m=None if width_m is None else float(width_m),
            u=tuple(answer["u"]),
            stopped=answer["stopped"],
            ticks=answer["ticks"],
            met_share=answer["met_share"],
        )

    def _answer(self, wait_s: float) -> dict[str, Any]:
        try:
            answer = self._process.port.receive(wait_s)
        except EOFError:
            answer = None
        if answer is None:
            raise UserError(
                "The process that drives the arm has ended or does not answer; the arm stops by itself."
            )
        return answer

    def close(self) -> None:
        """Bring the arm to rest and end the process."""
        self._process.end(_ENDING_S)
