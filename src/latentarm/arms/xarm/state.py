"""What the person's thread and the driver's thread both know."""

import threading
from dataclasses import dataclass, field
from typing import Literal, final

from latentarm.core.types import FloatArray

Condition = Literal[
    "off",
    "disabled",
    "releasing",
    "guided",
    "enabling",
    "enabled",
    "stopping",
    "fault",
    "lost",
    "emergency_stop",
]
"""Of the driver. *releasing*: guiding by hand was asked for, and is under way. *enabling*: so were commands.
*stopping*: enabled, and on its way to rest. *lost*: a fault of the connection."""

Request = Literal["halt", "guide", "enable", "stop", "recover"]

TAKES_COMMANDS: tuple[Condition, ...] = ("enabled", "stopping")


@final
@dataclass(frozen=True)
class Ordered:
    """A command on its way.

    Attributes:
        velocity: (n,), rad/s.
        ends_s: until when it counts, on the monotonic clock, s.
    """

    velocity: FloatArray
    ends_s: float


@final
@dataclass
class Shared:
    """Guarded by its condition variable, which is notified of every change the driver's thread must see.

    Attributes:
        condition: of the driver.
        reason: of a fault, one sentence.
        recoverable: whether recovering can end the fault.
        requests: what the driver's thread is asked to do.
        command: the newest that was not sent yet.
        ending: whether the driver's thread is to end.
    """

    condition: Condition = "off"
    reason: str = ""
    recoverable: bool = False
    requests: set[Request] = field(default_factory=set[Request])
    command: Ordered | None = None
    ending: bool = False
    changed: threading.Condition = field(default_factory=threading.Condition)

    def become(self, condition: Condition, reason: str = "", *, recoverable: bool = False) -> None:
        """Change; a command that was not sent is forgotten unless the arm goes on taking commands."""
        with self.changed:
            self.condition, self.reason, self.recoverable = condition, reason, recoverable
            if condition not in TAKES_COMMANDS:
                self.command = None
            self.changed.notify_all()
