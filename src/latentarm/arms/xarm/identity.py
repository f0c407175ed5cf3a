"""What an arm's controller says it is."""

import re
from dataclasses import dataclass
from typing import Final, final

from latentarm.arms.xarm.controller import LinkLostError

_LINE: Final = re.compile(r"(\d+),(\d+),([^,]*),([^,]*),[^,]*?[vV]?(\d+)\.(\d+)\.(\d+)")
_FIRMWARE: Final = re.compile(r"[vV]?(\d+)\.(\d+)\.(\d+)")

_NAMES: Final = {9: "Lite 6", 12: "850"}

BOUNDED_COMMANDS: Final = (1, 8, 0)
"""Older firmware drops the duration of a velocity command without a word, and moves on for ever."""

GRIPPER_PORT: Final = (1, 11, 0)
"""From this firmware on, the gripper has a port of its own."""

TIMED_REPORTS: Final = (2, 1, 0)
"""From this firmware on, reports say when they were measured."""


@final
@dataclass(frozen=True)
class Identity:
    """What the controller says of its arm.

    Attributes:
        firmware: major, minor and patch.
        axes: number of joints; None where the firmware is too old to say.
        kind: the manufacturer's number of its type, or None.
        arm_serial: serial number of the arm, or "".
        box_serial: serial number of the control box, or "".
    """

    firmware: tuple[int, int, int]
    axes: int | None = None
    kind: int | None = None
    arm_serial: str = ""
    box_serial: str = ""

    @property
    def version(self) -> str:
        """The firmware as text."""
        return ".".join(map(str, self.firmware))

    @property
    def name(self) -> str:
        """What the arm is sold as."""
        return _NAMES.get(self.kind or 0, f"xArm {self.axes}" if self.axes else "xArm")


def read_identity(told: str) -> Identity:
    """Read what the controller answers when asked for its version.

    Raises:
        LinkLostError: it is no version.
    """
    full = _LINE.search(told)
    if full is not None:
        axes, kind, arm, box, *firmware = full.groups()
        return Identity(
            (int(firmware[0]), int(firmware[1]), int(firmware[2])),
            int(axes),
            int(kind),
            _printable(arm),
            _printable(box),
        )
    short = _FIRMWARE.search(told)
    if short is None:
        raise LinkLostError(
            "What answers does not tell a firmware version: check that the address is an xArm's."
        )
    return Identity((int(short[1]), int(short[2]), int(short[3])))


def _printable(text: str) -> str:
    return "".join(letter for letter in text.strip()[:40] if letter.isprintable())
