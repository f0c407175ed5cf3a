"""The exchange of messages with the watchdog."""

import hashlib
import json
import secrets
import threading
from collections.abc import Callable, Mapping
from typing import Any, Final, final

from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.watchdog_state import WatchdogState, parse_state

STRING: Final = "std_msgs/msg/String"
SILENT_S: Final = 0.5  # a watchdog that is silent for so long is out of reach


@final
class Session:
    """One connection's exchange with the watchdog, under a unique key.

    Each message names the watchdog's state that we saw last, and its age, so that the watchdog knows the
    message's age on its own clock.
    """

    def __init__(self, link: Link, name: str, now_s: Callable[[], float]) -> None:
        self._link, self._now_s = link, now_s
        self._topic = f"{name}/command"
        self._key = secrets.token_hex(16)
        self._owner = hashlib.sha256(self._key.encode()).hexdigest()[:16]
        self._sequence = 0
        self._sending = threading.Lock()
        self._newest: tuple[WatchdogState, float] | None = None
        link.advertise(self._topic, STRING)
        link.subscribe(f"{name}/state", STRING, self._heard)

    @property
    def state(self) -> WatchdogState | None:
        """The watchdog's last readable state; None at first."""
        newest = self._newest
        return None if newest is None else newest[0]

    @property
    def silent(self) -> bool:
        """Whether the watchdog has been silent for too long."""
        newest = self._newest
        return newest is None or self._now_s() - newest[1] > SILENT_S

    @property
    def ours(self) -> bool:
        """Whether the arm is ours by the last state."""
        state = self.state
        return state is not None and state.owner == self._owner

    def tell(self, op: str, **entries: object) -> None:
        """Send a message, once the watchdog has said something."""
        newest = self._newest
        if newest is None:
            return
        state, heard_s = newest
        with self._sending:
            self._sequence += 1
            message = {
                "op": op,
                "session": self._key,
                "sequence": self._sequence,
                "seen": state.time_s,
                "age": max(self._now_s() - heard_s, 0.0),
                **entries,
            }
            self._link.publish(self._topic, {"data": json.dumps(message)})

    def _heard(self, message: Mapping[str, Any]) -> None:
        try:
            state = parse_state(message.get("data"))
        except ValueError:
            return
        self._newest = (state, self._now_s())
