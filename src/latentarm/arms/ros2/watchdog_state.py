"""The messages of the watchdog next to the arm."""

import math
from typing import Annotated, Final, Literal, Self, final

from pydantic import BaseModel, ConfigDict, Field, model_validator

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
