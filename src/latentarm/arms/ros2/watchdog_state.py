"""What the watchdog next to the arm tells its clients."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal, cast, final, get_args

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import parse_object

VERSION: Final = 1
"""Of the messages between the watchdog and us, as in ``docs/your-arm/latentarm_watchdog.py``."""

_LONGEST: Final = 65536

Phase = Literal["free", "disabled", "armed", "latched"]


@final
@dataclass(frozen=True)
class WatchdogState:
    """A state of the watchdog.

    Attributes:
        version: of its messages; where it is not ours, nothing else is known.
        time_s: on its own clock, s.
        controller: what it commands.
        kind: what that controller takes.
        joints: in the order of the controller.
        speed: the largest that it lets through, rad/s.
        stops_after_s: when a command has run out, it brakes within this time, s.
        ramp_s: how long it brakes, s.
        owner: digest of the session of its client; "" without one.
        phase: of the arm.
        reason: why it was latched or not armed, in one sentence; "" where there is nothing to say.
        obstacle: why it could not be armed now, in one sentence; "" where it could.
        arming: the number that its client enabled the arm with.
        stop_topic: where it hears of the emergency stop; "" where nowhere.
        stop_pressed: whether the emergency stop is pressed.
    """

    version: int
    time_s: float = math.nan
    controller: str = ""
    kind: str = ""
    joints: tuple[str, ...] = ()
    speed: tuple[float, ...] = ()
    stops_after_s: float = math.nan
    ramp_s: float = math.nan
    owner: str = ""
    phase: Phase = "free"
    reason: str = ""
    obstacle: str = ""
    arming: int = -1
    stop_topic: str = ""
    stop_pressed: bool = False


def parse_state(text: object) -> WatchdogState:
    """Read a state.

    Raises:
        ValueError: it is not one.
    """
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise ValueError("not a text")
    try:
        entries = parse_object(text, "the watchdog's state")
    except UserError as error:
        raise ValueError(str(error)) from error
    if not _whole(entries.get("latentarm_watchdog")):
        raise ValueError("not a state of the watchdog")
    version: int = entries["latentarm_watchdog"]
    if version != VERSION:
        return WatchdogState(version)
    joints, speed = entries.get("joints"), entries.get("speed")
    if not isinstance(joints, list) or not isinstance(speed, list) or len(joints) != len(speed):
        raise ValueError("no joints")
    if not all(map(_text, joints)) or not all(map(_finite, speed)):
        raise ValueError("no joints")
    phase = _entry(entries, "phase", _text)
    if phase not in get_args(Phase):
        raise ValueError("an unknown phase")
    return WatchdogState(
        version=version,
        time_s=_entry(entries, "time_s", _finite),
        controller=_entry(entries, "controller", _text),
        kind=_entry(entries, "kind", _text),
        joints=tuple(joints),
        speed=tuple(speed),
        stops_after_s=_entry(entries, "stops_after_s", _finite),
        ramp_s=_entry(entries, "ramp_s", _finite),
        owner=_entry(entries, "owner", _text),
        phase=cast(Phase, phase),
        reason=_entry(entries, "reason", _text),
        obstacle=_entry(entries, "obstacle", _text),
        arming=_entry(entries, "arming", _whole),
        stop_topic=_entry(entries, "stop_topic", _text),
        stop_pressed=_entry(entries, "stop_pressed", lambda x: isinstance(x, bool)),
    )


def _entry(entries: dict[str, Any], name: str, fits: Callable[[object], bool]) -> Any:
    value = entries.get(name)
    if not fits(value):
        raise ValueError(f"no {name}")
    return value


def _text(value: object) -> bool:
    return isinstance(value, str) and len(value) <= 1000


def _whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
