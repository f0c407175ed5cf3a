"""The controller's description of its arm."""

import re
from dataclasses import dataclass
from typing import Final, final

from latentarm.arms.xarm.controller import LinkLostError

_LINE: Final = re.compile(r"(\d+),(\d+),([^,]*),([^,]*),[^,]*?[vV]?(\d+)\.(\d+)\.(\d+)")
_FIRMWARE: Final = re.compile(r"[vV]?(\d+)\.(\d+)\.(\d+)")
_NAMES: Final = {9: "Lite 6", 12: "850"}
BOUNDED_COMMANDS: Final = (1, 8, 0)  # older firmware silently drops a velocity's duration, and moves for ever
GRIPPER_PORT: Final = (1, 11, 0)  # from this firmware on, the gripper has its own port
TIMED_REPORTS: Final = (2, 1, 0)  # from this firmware on, reports have a time of measurement


@final
@dataclass(frozen=True)
class Identity:
    """The controller's description of its arm."""

    firmware: tuple[int, int, int]  # major, minor and patch
    axes: int | None = None  # number of joints; None where the firmware is too old to say
    kind: int | None = None  # the manufacturer's number of the type
    arm_serial: str = ""  # or ""
    box_serial: str = ""  # of the control box, or ""

    @property
    def version(self) -> str:
        """The firmware as text."""
        return ".".join(map(str, self.firmware))

    @property
    def name(self) -> str:
        """The arm's name on the market."""
        return _NAMES.get(self.kind or 0, f"xArm {self.axes}" if self.axes else "xArm")


def read_identity(told: str) -> Identity:
    """Parse the controller's answer about its version. Raises LinkLostError if it is no version."""
    full = _LINE.search(told)
    if full is not None:
        axes, kind, arm, box, *firmware = full.groups()
        major, minor, patch = map(int, firmware)
        return Identity((major, minor, patch), int(axes), int(kind), _printable(arm), _printable(box))
    short = _FIRMWARE.search(told)
    if short is None:
        raise LinkLostError(
            "What answers does not tell a firmware version: check that the address is an xArm's."
        )
    return Identity((int(short[1]), int(short[2]), int(short[3])))


def _printable(text: str) -> str:
    return "".join(letter for letter in text.strip()[:40] if letter.isprintable())
