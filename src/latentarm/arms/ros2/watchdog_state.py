"""The messages of the watchdog next to the arm."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal, cast, final, get_args

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import parse_object

VERSION: Final = 1  # of its messages, as in ``docs/your-arm/latentarm_watchdog.py``

_LONGEST: Final = 65536

Phase = Literal["free", "disabled", "armed", "latched"]


@final
@dataclass(frozen=True)
class WatchdogState:
    """A state of the watchdog."""

    version: int  # of its messages; if it is not ours, nothing else is known
    time_s: float = math.nan  # on its own clock, s
    controller: str = ""  # that it commands
    kind: str = ""  # of that controller's commands
    joints: tuple[str, ...] = ()  # in the order of the controller
    speed: tuple[float, ...] = ()  # largest that it passes on, rad/s
    stops_after_s: float = math.nan  # it brakes within this time after a command has run out, s
    ramp_s: float = math.nan  # duration of braking, s
    owner: str = ""  # digest of its client's session; "" without one
    phase: Phase = "free"  # of the arm
    reason: str = ""  # why it was latched or not armed, in one sentence, or ""
    obstacle: str = ""  # why it could not be armed now, in one sentence, or ""
    arming: int = -1  # the number that its client enabled the arm with
    stop_topic: str = ""  # topic of the emergency stop, or ""
    stop_pressed: bool = False  # whether the emergency stop is pressed


def parse_state(text: object) -> WatchdogState:
    """Parse a state; raises ValueError for anything else."""
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
