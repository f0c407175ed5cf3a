"""What the teleoperation page does to a simulated person's eye and hand: it shows and sends now and then."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import Input
from latentarm_research.people.contract import Moment


@final
@dataclass(frozen=True)
class PageRates:
    """How often the page shows and sends, and how long messages are under way.

    The first two are the page's own constants, which a test compares.
    """

    input_s: float = 0.02  # time between inputs that the page sends (`PERIOD_MS` of `drive_input.js`), s
    state_s: float = 0.02  # time between states that the server sends to the driver (`DRIVER_PERIOD_S`), s
    frame_s: float = 1.0 / 60.0  # time between frames of the display, s: 60 Hz, as most displays
    network_s: float = 0.001  # from page to server or back, s: chosen for both on one machine


PAGE: Final = PageRates()  # the page on the machine that drives the arm

SLOW: Final = 0.5  # share of the full speed with which the page lets a new person begin

_EARLY: Final = 1e-6
"""Periods by which something may come early, so that sums of rounded times do not make it late."""


@final
class Screen:
    """Shows what there is to see when the page does."""

    def __init__(
        self,
        rates: PageRates,
        period_s: float,  # time between calls, s
    ) -> None:
        self._rates = rates
        self._period_s = period_s
        oldest_s = rates.network_s + rates.state_s + rates.frame_s
        self._kept = math.ceil(oldest_s / period_s) + 1
        self.reset()

    def reset(self) -> None:
        """Show nothing of the last drive."""
        self._views = deque[Moment](maxlen=self._kept + 1)
        self._call = -1

    def shown(self, moment: Moment) -> Moment:
        """What is on the screen now: the newest state that had arrived at the last frame."""
        self._call += 1
        self._views.append(moment)
        rates = self._rates
        frame_s = _last(self._call * self._period_s, rates.frame_s)
        sent_s = _last(frame_s - rates.network_s, rates.state_s)
        age = self._call - math.floor(sent_s / self._period_s + _EARLY)
        return self._views[-1 - min(age, len(self._views) - 1)]


@final
class Wire:
    """Sends what the hand does when the page does.

    The page sends the stick's deflection every so often, and at once when the stick is pushed or let go, and
    when another mode is asked for.
    """

    def __init__(self, rates: PageRates, period_s: float) -> None:
        self._rates = rates
        self._period_s = period_s
        self._late_calls = math.ceil(rates.network_s / period_s - _EARLY)
        self.reset()

    def reset(self) -> None:
        """Have nothing of the last drive under way."""
        self._under_way = deque[tuple[int, Input]]()
        self._given: Input | None = None
        self._arrived: Input | None = None
        self._call = -1

    def carried(self, given: Input) -> Input:
        """What has arrived: the newest deflection sent, or rest before any, and a mode switch once."""
        self._call += 1
        if self._is_sent(given):
            self._under_way.append((self._call + self._late_calls, given))
        self._given = given
        switches = False
        while self._under_way and self._under_way[0][0] <= self._call:
            self._arrived = self._under_way.popleft()[1]
            switches |= self._arrived.switch_mode
        u = np.zeros_like(given.u) if self._arrived is None else self._arrived.u
        return Input(u, switch_mode=switches)

    def _is_sent(self, given: Input) -> bool:
        if self._given is None or given.switch_mode or given.u.any() != self._given.u.any():
            return True
        now_s = self._call * self._period_s
        return _last(now_s, self._rates.input_s) > _last(now_s - self._period_s, self._rates.input_s)


def _last(time_s: float, period_s: float) -> float:
    """The last multiple of a period up to a time, s."""
    return math.floor(time_s / period_s + _EARLY) * period_s
