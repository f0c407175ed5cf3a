"""An arm that was stopped because something holds it draws back a little, and rests."""

import math
from collections import deque
from typing import Final, final

import numpy as np

from latentarm.control.safety.body import Body
from latentarm.control.safety.bounds import Bounds
from latentarm.control.safety.small import largest, some
from latentarm.types import FloatArray

YIELDING: Final = "yielding"
"""Stands among the limits of each command that draws back."""

FARTHEST_M: Final = 0.03
"""Once a point of the arm has gone back this far, the arm slows down and rests."""

LONGEST_S: Final = 1.0
"""No command draws back for longer than this, s; the last one is ramped down as any other."""

PACE: Final = 0.5
"""Commands are taken back at this share of their speed."""

LOOK_S: Final = 0.5
"""An arm that does not stand still so long after its stop does not draw back, s."""

_STILL_RAD: Final = 2e-3
_REMEMBERED_S: Final = LOOK_S + 1.0


@final
class Yielding:
    """After a following error that looks like contact, takes back the commands of the last second.

    A command to stand still does not relieve what the arm presses on: its servo goes on towards the position
    that was commanded, which lies inside the thing. So the commands are taken back, the newest first, at half
    their speed. This unwinds the servo and then leads the arm back along its path, until a point of it has
    gone back by `FARTHEST_M`, for at most `LONGEST_S`.

    Contact is not measured. A following error counts as one if the arm then stands still and a joint is still
    off, in readings that change; and if this leaves the point that is farthest off behind where it was
    commanded to go. An encoder that froze repeats itself, readings that are late catch up, and what is pushed
    along is not behind. Where this is mistaken, the arm moves to where it was within the last second.

    Args:
        bounds: the limits.
        body: the arm.
    """

    def __init__(self, bounds: Bounds, body: Body) -> None:
        self._body = body
        self._dt_s = bounds.dt_s
        self._margin_rad = bounds.config.following_error
        self._looks = math.ceil(max(bounds.lag_s, bounds.stop_s) / bounds.dt_s)
        # Each reading with the command since the one before, the newest last.
        self._past: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=round(_REMEMBERED_S / bounds.dt_s))
        self._looked: int | None = None
        self._back: int | None = None
        self._start_m: FloatArray = np.zeros((0, 3))

    @property
    def on(self) -> bool:
        """Whether the arm draws back, or is looked at to decide whether it should."""
        return self._looked is not None

    def end(self) -> None:
        """Rest, and forget the past."""
        self._looked = self._back = None
        self._past.clear()

    def saw(self, q: FloatArray, velocity: FloatArray) -> None:
        """Remember a reading (n,), rad, and the command since the one before, (n,), rad/s."""
        if self._back is None:
            self._past.append((q, velocity))

    def begin(self) -> None:
        """A following error has just stopped the arm."""
        self._looked = 0

    def wanted(self, q: FloatArray) -> FloatArray | None:
        """What to ask of the filters now; call this in every tick in which the arm is stopped.

        Args:
            q: (n,), measured joint positions, rad.

        Returns:
            (n,), rad/s; None where the arm is to stand still.
        """
        if self._looked is None:
            return None
        if self._back is None:
            self._looked += 1
            if not self._held():
                if self._looked * self._dt_s >= LOOK_S:
                    self.end()
                return None
            while not some(self._past[-1][1]):
                self._past.pop()
            self._back, self._start_m = 0, self._points(q)
        taken = int(PACE * self._back)
        gone = largest(np.linalg.norm(self._points(q) - self._start_m, axis=1))
        if gone >= FARTHEST_M or self._back * self._dt_s >= LONGEST_S or taken >= len(self._past):
            self.end()
            return None
        self._back += 1
        return -PACE * self._past[-1 - taken][1]

    def _held(self) -> bool:
        """Whether what was seen until the stop and since looks as if something holds the arm."""
        looked = self._looked or 0
        if looked <= self._looks or len(self._past) <= looked + self._looks:
            return False
        q, velocity = (np.array(part) for part in zip(*self._past, strict=True))
        if largest(np.abs(q[-1] - q[-1 - self._looks // 2])) > _STILL_RAD:
            return False
        way = self._dt_s * velocity
        commanded = q[0] + way[1:].sum(axis=0)
        behind = np.abs(commanded - q[-1])
        alive = (np.diff(q[-1 - looked :, int(behind.argmax())]) != 0.0).mean() >= 0.25
        ahead_m = self._points(commanded)
        off_m = ahead_m - self._points(q[-1])
        point = int(np.linalg.norm(off_m, axis=1).argmax())
        going_m = ahead_m - self._points(commanded - way[-looked - self._looks :].sum(axis=0))
        return bool(largest(behind) > self._margin_rad and alive and off_m[point] @ going_m[point] > 0.0)

    def _points(self, q: FloatArray) -> FloatArray:
        """(P, 3), m."""
        chain = self._body.robot.chain
        return chain.points(chain.link_transforms(q), self._body.link, self._body.local)
