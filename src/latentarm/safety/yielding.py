"""An arm that was stopped because something holds it draws back a little and rests."""

import math
from collections import deque
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.safety.body import Body
from latentarm.safety.limits import Bounds
from latentarm.safety.small import largest

YIELDING: Final = "yielding"  # stands among the limits of each command that draws back
FARTHEST_M: Final = 0.03  # once a point of the arm has gone back this far, the arm slows down and rests
LONGEST_S: Final = 1.0
"""No command draws back for longer than this, s; the last one is ramped down as any other."""

PACE: Final = 0.5
"""Commands are taken back at this share of their speed, and joints go to where they are at this share."""

LOOK_S: Final = 0.5  # an arm that does not stand still so long after its stop does not draw back, s
_STILL_RAD: Final = 2e-3
_REMEMBERED_S: Final = LOOK_S + 1.0


@final
class Yielding:
    """After a force, or a following error that looks like contact, leads the arm back the way it came.

    A command to stand still does not relieve what the arm presses on: its servo goes on towards the position
    that was commanded, inside the thing. So the arm is commanded to where it is measured, then back along its
    last commands before it pressed, until a point of it has gone back by `FARTHEST_M`, for at most
    `LONGEST_S`.

    Without a measured force contact is inferred: the arm stands still, a joint is still off, in readings
    that change, and it or the farthest point is behind where it was commanded to go. A frozen encoder repeats
    itself, late readings catch up, and an arm that is pushed along is not behind.
    """

    def __init__(self, bounds: Bounds, body: Body) -> None:
        self._body = body
        self._dt_s = bounds.dt_s
        self._margin_rad = bounds.config.following_error
        self._most = round(LONGEST_S / bounds.dt_s)
        self._looks = math.ceil(max(bounds.lag_s, bounds.stop_s) / bounds.dt_s)
        # Each reading with the command since the one before, the newest last.
        self._past: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=round(_REMEMBERED_S / bounds.dt_s))
        # The last moving commands before the arm pressed on something, the newest last, rad/s.
        self._moves: deque[FloatArray] = deque(maxlen=round(PACE * LONGEST_S / bounds.dt_s))
        self._fastest = PACE * bounds.speed
        self._looked: int | None = None
        self._felt = False
        self._way_back: list[FloatArray] | None = None
        self._start_m: FloatArray = np.zeros((0, 3))

    @property
    def on(self) -> bool:
        """Whether the arm draws back, or is watched to decide whether it should."""
        return self._looked is not None

    def end(self) -> None:
        """Rest, and forget the past."""
        self._looked = self._way_back = None
        self._past.clear()
        self._moves.clear()

    def saw(self, q: FloatArray, velocity: FloatArray, *, pressing: bool) -> None:
        """Remember a reading (n,), rad, and the command since the one before, (n,), rad/s.

        ``pressing``: see `ToolForce.pressing`.
        """
        if self._way_back is None:
            self._past.append((q, velocity))
            if velocity.any() and not pressing:
                self._moves.append(velocity)

    def begin(self) -> None:
        """A following error has just stopped the arm."""
        self._looked, self._felt = 0, False

    def felt(self) -> None:
        """A measured force has just stopped the arm, which draws back once it stands still."""
        self._looked, self._felt = 0, True

    def wanted(self, q: FloatArray) -> FloatArray | None:
        """The velocity (n,), rad/s, to ask of the filters now; None where the arm is to stand still.

        Call this with the measured positions (n,), rad, in every tick in which the arm is stopped.
        """
        if self._looked is None:
            return None
        if self._way_back is None:
            self._looked += 1
            if not self._felt:
                self._way_back = self._decided(self._looked)
            elif not self._past[-1][1].any():
                self._way_back = self._taken_back()
            self._start_m = self._points(q)
            if self._way_back is None:
                if self._looked * self._dt_s >= LOOK_S:
                    self.end()
                return None
        gone = largest(np.linalg.norm(self._points(q) - self._start_m, axis=1))
        if gone >= FARTHEST_M or not self._way_back:
            self.end()
            return None
        return self._way_back.pop()

    def _decided(self, looked: int) -> list[FloatArray] | None:
        """Velocities back, the last first, rad/s, after so many ticks; None where nothing holds the arm."""
        if looked <= self._looks or len(self._past) <= looked + self._looks:
            return None
        q, velocity = (np.array(part) for part in zip(*self._past, strict=True))
        if largest(np.abs(q[-1] - q[-1 - self._looks // 2])) > _STILL_RAD:
            return None
        way = self._dt_s * velocity
        commanded = q[0] + way[1:].sum(axis=0)
        before = commanded - way[-looked - self._looks :].sum(axis=0)
        ahead, going = commanded - q[-1], commanded - before
        joint = int(np.abs(ahead).argmax())
        ahead_m = self._points(commanded) - self._points(q[-1])
        point = int(np.linalg.norm(ahead_m, axis=1).argmax())
        going_m = self._points(commanded)[point] - self._points(before)[point]
        behind = ahead[joint] * going[joint] > 0.0 or ahead_m[point] @ going_m > 0.0
        alive = np.count_nonzero(np.diff(q[-1 - looked :, joint])) >= 0.25 * looked
        if not (behind and alive and abs(ahead[joint]) > self._margin_rad):
            return None
        to_measured = math.ceil(largest(np.abs(ahead) / self._fastest) / self._dt_s)
        back = [*self._taken_back(), *([-ahead / (to_measured * self._dt_s)] * to_measured)]
        return back[-self._most :]

    def _taken_back(self) -> list[FloatArray]:
        """The last commands backwards at the share `PACE` of their speed, the last first, rad/s."""
        return [-PACE * velocity for velocity in self._moves for _ in range(round(1.0 / PACE))]

    def _points(self, q: FloatArray) -> FloatArray:
        """(P, 3), m."""
        chain = self._body.robot.chain
        return chain.points(chain.link_transforms(q), self._body.link, self._body.local)
