"""What leaves the loop for the gripper: asked by a fresh input, within limits, still when the arm stops."""

import math
from typing import Final, final, get_args

from latentarm.control.safety.config import SafetyConfig
from latentarm.robots.gripper import Gripper
from latentarm.types import GripperAsk, GripperCommand, GripperReading, Stop

_ASKS: Final = (None, *get_args(GripperAsk))

_ASTRAY: Final = 0.01
"""A reading this far outside the gripper's range is wrong, m."""


@final
class GripperFilter:
    """Turns what a person asks of the gripper into commands, and takes nothing back that holds something.

    An ask counts once, when it appears, and only while the arm may move. Then the fingers go where it says,
    no faster and no harder than the limits allow. When the arm is stopped, fingers in motion stop where they
    are, and what they hold stays held with the same force; an ask from before does not go on afterwards.
    While inputs falter they wait, and go on when inputs come back.

    Args:
        gripper: what is driven, or None where there is nothing: then there are no commands.
        config: the limits; where the gripper can do less, that counts.
    """

    def __init__(self, gripper: Gripper | None, config: SafetyConfig) -> None:
        self._gripper = gripper
        self._speed = self._force = 0.0
        if gripper is not None:
            self._speed = min(config.gripper_speed, gripper.speed_m_s)
            self._force = min(config.gripper_force, gripper.force_n)
        self.reset()

    def reset(self) -> None:
        """Begin a new episode: the gripper stays as it is until it is asked."""
        self._held: GripperAsk | None = None
        self._target_m: float | None = None
        self._reading: GripperReading | None = None
        self._fresh = False
        self._still_at_m: float | None = None

    @property
    def reading(self) -> GripperReading | None:
        """What the gripper measured in this tick; None without a gripper, or where that cannot be used."""
        return self._reading if self._fresh else None

    @property
    def target_m(self) -> float | None:
        """Where it was told to go, m; until it was told, where it is, and 0 where it holds something.

        None where there is no `reading`.
        """
        reading = self.reading
        if reading is None or self._target_m is not None:
            return None if reading is None else self._target_m
        return 0.0 if reading.holding else max(reading.width_m, 0.0)

    def tick(self) -> None:
        """A new period begins: what was read before counts only for where to stand still."""
        self._fresh = False

    def saw(self, reading: GripperReading | None) -> Stop | None:
        """Take a reading.

        Args:
            reading: of the gripper, whatever a driver gives.

        Returns:
            Why it cannot be used, or None.
        """
        if self._gripper is None:
            return None
        if reading is None:
            return _invalid("The arm gives no reading of its gripper.")
        width, holding = float(reading.width_m), bool(reading.holding)
        # Written so that a value that is not a number fails too.
        if not -_ASTRAY <= width <= self._gripper.width_m + _ASTRAY:
            return _invalid("The gripper's opening is outside its range.")
        self._reading = GripperReading(width, holding)
        self._fresh = True
        return None

    @staticmethod
    def known(asked: object) -> bool:
        """Whether this is something that can be asked."""
        return asked is None or (isinstance(asked, str) and asked in _ASKS)

    def ask(self, asked: GripperAsk | None, *, engaged: bool) -> None:
        """Take what a fresh input asks.

        Args:
            asked: what is asked; counts when it changes.
            engaged: whether the arm may move.
        """
        new, self._held = asked != self._held, asked
        if not (new and engaged) or self._gripper is None or not self._fresh or asked is None:
            return
        opens = self._closed() if asked == "toggle" else asked == "open"
        self._target_m = self._gripper.width_m if opens else 0.0

    def command(self, *, engaged: bool, falters: bool) -> GripperCommand | None:
        """Where the gripper is to go now.

        Args:
            engaged: whether the arm may move; if not, what was asked is forgotten.
            falters: whether fresh inputs are missing for a moment.

        Returns:
            The command, or None where the gripper is to stay as it is.
        """
        if self._target_m is None:
            return None
        if engaged and not falters:
            self._still_at_m = None
            return GripperCommand(self._target_m, self._speed, self._force)
        if self._still_at_m is None:
            # Where it is now, and not at each later reading: noise would let it creep.
            self._still_at_m = self._here(self._target_m)
        if not engaged:
            self._target_m = self._still_at_m
        return GripperCommand(self._still_at_m, self._speed, self._force)

    def _here(self, target_m: float) -> float:
        """The opening at which it stands still; where something is held, what it was closing towards, m."""
        if self._reading is None or self._reading.holding:
            return target_m
        return min(max(self._reading.width_m, 0.0), self._width)

    @property
    def _width(self) -> float:
        return math.inf if self._gripper is None else self._gripper.width_m

    def _closed(self) -> bool:
        """Whether it is closed, or on its way."""
        if self._target_m is not None:
            return self._target_m < 0.5 * self._width
        reading = self._reading
        return reading is not None and (reading.holding or reading.width_m < 0.5 * self._width)


def _invalid(reason: str) -> Stop:
    return Stop(reason, untrusted=True, code="gripper_invalid")
