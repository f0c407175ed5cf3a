"""The last filter of gripper commands: who may ask, within which limits, still when the arm stops."""

import math
from typing import Final, Literal, final, get_args

from latentarm.core.types import GripperAsk, GripperCommand, GripperReading, Stop
from latentarm.robots.gripper import Gripper
from latentarm.safety.config import SafetyConfig

OPENS_AFTER_S: Final = 1.0
"""The gripper of an arm that is not enabled opens where this was held down for so long without a break, s."""

_ASKS: Final = (None, *get_args(GripperAsk))
_ASTRAY: Final = 0.01  # a reading this far outside the gripper's range is wrong, m


@final
class GripperFilter:
    """Turns requests into commands for the gripper, and never lets go of a held thing by itself.

    Three may ask, and the fingers move only while the one who asked still may:

    - the person who drives, while the arm is enabled. An ask counts once, when it appears;
    - a person who guides the disengaged arm by hand, as long as they do;
    - a person who holds down the button that opens the gripper of a disengaged arm: after `OPENS_AFTER_S`
      without a break it opens as long as that is held. Nothing closes it then. Inputs may be missing as long
      as an arm that moves would not be stopped for it, and the fingers wait meanwhile.

    Otherwise the fingers stay where they are, and a held thing stays held as hard as at that moment, and no
    harder: when the arm is stopped, when guiding ends, and after the arm is enabled until something new is
    asked. While inputs falter they wait, and go on when inputs come back.

    Without a gripper there are no commands. The gripper's own limits count where they are below ``config``.
    """

    def __init__(self, gripper: Gripper | None, config: SafetyConfig) -> None:
        self._gripper = gripper
        self._gap_s = config.input_grace_s
        self._speed = self._force = 0.0
        if gripper is not None:
            self._speed = min(config.gripper_speed, gripper.speed_m_s)
            self._force = min(config.gripper_force, gripper.force_n)
        self.reset()

    def reset(self) -> None:
        """Begin a new episode: the gripper stays as it is until it is asked."""
        self._held: GripperAsk | None = None
        self._target_m: float | None = None
        self._asker: Literal["driver", "guide", "opener"] | None = None
        self._guided = False
        self._guide_asks: GripperAsk | None = None
        self._opens_since_s = self._opens_heard_s = math.inf
        self._reading: GripperReading | None = None
        self._fresh = False

    @property
    def reading(self) -> GripperReading | None:
        """The gripper's reading of this tick; None without a gripper, or where it cannot be used."""
        return self._reading if self._fresh else None

    @property
    def target_m(self) -> float | None:
        """The commanded opening, m; before that the measured one, 0 if it holds, None without `reading`."""
        reading = self.reading
        if reading is None or self._target_m is not None:
            return None if reading is None else self._target_m
        return 0.0 if reading.holding else max(reading.width_m, 0.0)

    def tick(self) -> None:
        """Begin a tick: the reading of the one before is old."""
        self._fresh = False

    def saw(self, reading: GripperReading | None) -> Stop | None:
        """Take this tick's reading; why it cannot be used, or None."""
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
        """Whether this is a request that a gripper can meet."""
        return asked is None or (isinstance(asked, str) and asked in _ASKS)

    def ask(self, asked: GripperAsk | None, *, engaged: bool) -> None:
        """Take a fresh input's request, which counts when it changes."""
        new, self._held = asked != self._held, asked
        if new and engaged and asked is not None and self._fresh:
            self._aim(asked)
            self._asker = "driver"

    def guided(self, asked: GripperAsk | None) -> None:
        """The arm is guided by hand until the next command; the guide asks this, or nothing new."""
        self._guided, self._guide_asks = True, asked

    def command(
        self, time_s: float, pace: float, *, engaged: bool, opens: bool | None = None
    ) -> GripperCommand | None:
        """The next command, once per tick; None where the gripper has never been commanded.

        Args:
            time_s: the loop's clock, s.
            pace: share of its speed that it may move with, in [0, 1]; 0 while inputs falter.
            engaged: whether the arm may move.
            opens: whether a fresh input says that the opening button is held down; None without an input.
        """
        guided, asked = self._guided and not engaged, self._guide_asks
        self._guided, self._guide_asks = False, None
        frees = not engaged and self._held_long_enough(opens, time_s)
        may = {"driver": engaged, "guide": guided, "opener": frees}
        if self._asker is not None and not may[self._asker]:
            # Where it is now, and not at each later reading: noise would let it creep.
            self._target_m, self._asker = self._here(), None
        if guided and asked is not None and self._fresh:
            self._aim(asked)
            self._asker = "guide"
        elif frees and self._asker is None:
            self._aim("open")
            self._asker = "opener"
        if self._target_m is None:
            return None
        return GripperCommand(self._target_m, 0.0 if self._asker is None else pace * self._speed, self._force)

    def _held_long_enough(self, opens: bool | None, time_s: float) -> bool:
        if opens:
            self._opens_since_s = min(self._opens_since_s, time_s)
            self._opens_heard_s = time_s
        elif opens is False or time_s - self._opens_heard_s > self._gap_s:
            self._opens_since_s = math.inf
        return bool(opens) and time_s - self._opens_since_s >= OPENS_AFTER_S

    def _aim(self, asked: GripperAsk) -> None:
        if self._gripper is not None:
            opens = self._closed() if asked == "toggle" else asked == "open"
            self._target_m = self._gripper.width_m if opens else 0.0

    def _here(self) -> float | None:
        """The opening at which it stands still, m; where something is held, the target of closing."""
        if self._reading is None or self._reading.holding:
            return self._target_m
        return min(max(self._reading.width_m, 0.0), self._width)

    @property
    def _width(self) -> float:
        return math.inf if self._gripper is None else self._gripper.width_m

    def _closed(self) -> bool:
        """Whether it is closed, or on its way."""
        if self._asker is not None and self._target_m is not None:
            return self._target_m < 0.5 * self._width
        reading = self._reading
        return reading is not None and (reading.holding or reading.width_m < 0.5 * self._width)


def _invalid(reason: str) -> Stop:
    return Stop(reason, untrusted=True, code="gripper_invalid")
