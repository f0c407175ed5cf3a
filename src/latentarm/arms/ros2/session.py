"""The exchange of messages with the watchdog."""

import hashlib
import json
import math
import secrets
import threading
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Final, Literal, Self, final

from pydantic import BaseModel, ConfigDict, Field, model_validator

from latentarm.arms.ros2.link import Link
from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import parse_object

VERSION: Final = 1  # of its messages, as in ``docs/your-arm/latentarm_watchdog.py``
_LONGEST: Final = 65536
_VERSION_NAME: Final = "latentarm_watchdog"
Text = Annotated[str, Field(max_length=1000)]


@final
class WatchdogState(BaseModel):
    """A state of the watchdog; of one with another version nothing but the version is known."""

    model_config = ConfigDict(frozen=True, strict=True, allow_inf_nan=False)
    version: int = Field(alias=_VERSION_NAME)  # of its messages
    time_s: float = math.nan  # on its own clock, s
    controller: Text = ""  # that it commands
    kind: Text = ""  # of that controller's commands
    joints: tuple[Text, ...] = ()  # in the order of the controller
    speed: tuple[float, ...] = ()  # largest that it passes on, rad/s
    stops_after_s: float = math.nan  # it brakes within this time after a command has run out, s
    ramp_s: float = math.nan  # duration of braking, s
    owner: Text = ""  # digest of its client's session; "" without one
    phase: Literal["free", "disabled", "armed", "latched"] = "free"  # of the arm
    reason: Text = ""  # why it was latched or not armed, in one sentence, or ""
    obstacle: Text = ""  # why it could not be armed now, in one sentence, or ""
    arming: int = -1  # the number that its client enabled the arm with
    stop_topic: Text = ""  # topic of the emergency stop, or ""
    stop_pressed: bool = False  # whether the emergency stop is pressed

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.version == VERSION and len(self.model_fields_set) < len(type(self).model_fields):
            raise ValueError("something is missing")
        if len(self.joints) != len(self.speed):
            raise ValueError("not every joint has a speed")
        return self


def parse_state(text: object) -> WatchdogState:
    """Parse a state; raises ValueError for anything else."""
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise ValueError("not a text")
    try:
        version = parse_object(text, "the watchdog's state").get(_VERSION_NAME)
    except UserError as error:
        raise ValueError(str(error)) from error
    if version != VERSION:
        return WatchdogState.model_validate({_VERSION_NAME: version})
    return WatchdogState.model_validate_json(text)


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
