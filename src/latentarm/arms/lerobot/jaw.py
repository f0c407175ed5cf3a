"""The gripper of a LeRobot arm: an opening in m for the servo's 0 (closed) to 100 (open)."""

from typing import Final, final

import numpy as np

_BEHIND: Final = 6.0  # a jaw this far behind its target, of 100, presses on something
_HOLDS_S: Final = 0.2  # and holds it after this time


@final
class Jaw:
    """Moves a target towards the commanded opening, and reports the jaw's opening.

    The opening is assumed to grow evenly with the servo's angle: for a jaw on a hinge, an approximation.
    """

    def __init__(self, width_m: float) -> None:
        self._per_m = 100.0 / width_m
        self._target = self._goal = self._at = 0.0
        self._speed = 0.0
        self._behind_s = 0.0

    def begin(self, at: float) -> None:
        """Stay at the jaw's position, from 0 to 100."""
        self._target = self._goal = self._at = at
        self._behind_s = 0.0

    def command(self, width_m: float, speed_m_s: float) -> None:
        """Go to a width, m, at a speed, m/s; at 0 it halts."""
        if speed_m_s <= 0.0:
            self.halt()
            return
        self._goal = float(np.clip(width_m * self._per_m, 0.0, 100.0))
        self._speed = speed_m_s * self._per_m

    def halt(self) -> None:
        """Stop here; a hold persists, as hard as now."""
        if self._speed > 0.0 and self._behind_s < _HOLDS_S:
            self._target = self._at
        # Once: a jaw that gives way later presses back.
        self._goal, self._speed = self._target, 0.0

    def advance(self, span_s: float, at: float) -> float:
        """The present target, from 0 to 100, after ``span_s`` with the jaw at ``at``, from 0 to 100."""
        self._at = at
        behind = at - self._target > _BEHIND
        self._behind_s = self._behind_s + span_s if behind else 0.0
        most = self._speed * span_s
        self._target += float(np.clip(self._goal - self._target, -most, most))
        # Pressed no harder than this far beyond what it holds.
        self._target = max(self._target, min(at, 100.0) - 3.0 * _BEHIND)
        return self._target

    def measured(self) -> tuple[float, bool]:
        """The opening, m, and whether it holds something."""
        return max(self._at, 0.0) / self._per_m, self._behind_s >= _HOLDS_S
