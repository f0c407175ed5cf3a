"""State shared by the caller's thread and the driver's thread."""

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
    """A command to send."""

    velocity: FloatArray  # (n,), rad/s
    ends_s: float  # its end on the monotonic clock, s


@final
@dataclass
class Shared:
    """Guarded by its condition variable, which is notified of every change for the driver's thread."""

    condition: Condition = "off"  # of the driver
    reason: str = ""  # of a fault, one sentence
    recoverable: bool = False  # whether recovering can end the fault
    requests: set[Request] = field(default_factory=set[Request])  # to the driver's thread
    command: Ordered | None = None  # the newest unsent one
    ending: bool = False  # whether the driver's thread is to end
    changed: threading.Condition = field(default_factory=threading.Condition)

    def become(self, condition: Condition, reason: str = "", *, recoverable: bool = False) -> None:
        """Change the condition; drops an unsent command unless the arm goes on taking commands."""
        with self.changed:
            self.condition, self.reason, self.recoverable = condition, reason, recoverable
            if condition not in TAKES_COMMANDS:
                self.command = None
            self.changed.notify_all()
