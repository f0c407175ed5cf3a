"""Actions that come from another process, judged by this one's clock."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final, cast, final

import numpy as np

from latentarm.arms.helper_process import MessagePort
from latentarm.control.input_port import InputSource
from latentarm.core.types import GripperAsk, Input

LET_GO_S: Final = 0.5
"""Fresh neutral actions for so long enable an arm again that had stopped because actions were missing, s."""


@final
class PortInputs(InputSource):
    """The newest action that has come through a port.

    Until the first one comes, the input is neutral and fresh: the arm stands still and can be enabled. From
    then on an action is as old as the time since its sender sent it, by the clock that all processes of the
    machine share, so one that was held up anywhere does not count.

    Args:
        port: where actions come from.
        input_dim: d.
        asked: called with every message that is not an action.
        gone: called once the other end is gone.
    """

    def __init__(
        self,
        port: MessagePort,
        input_dim: int,
        asked: Callable[[Mapping[str, Any]], None],
        gone: Callable[[], None],
    ) -> None:
        self._port, self._asked, self._gone = port, asked, gone
        self._u = np.zeros(input_dim)
        self._gripper: GripperAsk | None = None
        self._sent_s: float | None = None
        self._neutral_since_s = math.inf

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        self._drain()
        gripper, self._gripper = self._gripper, None
        if self._sent_s is None:
            return Input(self._u), 0.0
        age_s = now_s - self._sent_s
        return Input(self._u, gripper=gripper), age_s if age_s >= 0.0 else math.inf

    def let_go(self, now_s: float, dead_zone: float, timeout_s: float) -> bool:
        """Whether fresh neutral actions have come for `LET_GO_S`; to be asked in every tick.

        Args:
            now_s: the loop's clock.
            dead_zone: length of an input up to which it is neutral.
            timeout_s: how long an action counts, s.
        """
        fresh = self._sent_s is not None and now_s - self._sent_s <= timeout_s
        if not fresh or not float(np.linalg.norm(self._u)) <= dead_zone:
            self._neutral_since_s = math.inf
        elif self._neutral_since_s == math.inf:
            self._neutral_since_s = now_s
        return now_s - self._neutral_since_s >= LET_GO_S

    def _drain(self) -> None:
        try:
            while (message := self._port.receive()) is not None:
                if "u" in message:
                    self._u = np.array(message["u"], dtype=np.float64)
                    self._sent_s = float(message["sent_s"])
                    self._gripper = cast("GripperAsk | None", message["gripper"]) or self._gripper
                else:
                    self._asked(message)
        except EOFError:
            self._gone()
