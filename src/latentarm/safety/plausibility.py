"""Whether the joint readings are plausible, given what the arm was commanded to do."""

import math
from collections import deque
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Stop, StopCode
from latentarm.robots.robot import Robot
from latentarm.safety.limits import LATE_PERIODS, Bounds
from latentarm.safety.small import largest

_BUCKETS = 9
"""The commands of the last `Bounds.lag_s` are kept as lowest and highest positions in this many time bins,
so that a check costs the same at every rate. The newest bin is still being filled."""


FOLLOWING_ERRORS: Final[tuple[StopCode, ...]] = ("joint_astray", "slide_astray")
"""Codes of the stops by a following error."""

_BOTH_SIGNS = np.array([[1.0], [-1.0]])


@final
class Plausibility:
    """Compares each reading with the one before it and with the commanded motion.

    Three faults are found:

    - *jump*: a joint's reading moved farther than the joint can move in the time that has passed;
    - *freeze*: a joint's reading repeats exactly while the joint was commanded to move;
    - *following error*: over a sliding window a joint moved less far, or farther, than commanded.

    The commanded position ``c(t)`` is the integral of the commands. A reading may be late, and the arm
    follows with a lag. Both average over past commands, so a healthy joint's reading lies between the
    lowest and the highest ``c`` of the last ``lag_s``, but for a constant offset. The offset cancels when
    two moments are compared: the displacement since an earlier moment, the anchor, lies between
    ``min c - max c_anchor`` and ``max c - min c_anchor``, minima and maxima taken over the ``lag_s`` before
    each. Only what lies outside counts as an error, so a lag within ``lag_s`` never adds up to one, however
    fast the arm moves. A joint that has been commanded one way for longer than any lag must be moving: where
    its new readings repeat, the commanded displacement counts in full. The anchor is at most
    ``following_window_s`` old, so slow drift is no error either.
    """

    def __init__(self, bounds: Bounds, robot: Robot) -> None:
        config = bounds.config
        self._names = robot.joint_names
        self._slides = robot.chain.slide
        self._units = ["m" if slides else "rad" for slides in robot.chain.slide]
        self._fastest = robot.limits.velocity
        self._hold_s = bounds.hold_s
        self._jump = config.jump_margin + LATE_PERIODS * bounds.dt_s * bounds.speed
        self._slowest_jump = float(self._jump.min())
        self._freeze = config.freeze_margin
        self._following = config.following_error
        self._window_s = config.following_window_s
        self._bucket_s = bounds.lag_s / (_BUCKETS - 1)
        self._reading: FloatArray | None = None
        self._time_s = 0.0
        # All positions below are (2, n): themselves, and their negatives. So one maximum finds both the
        # highest and the lowest.
        self._commanded = np.zeros((2, bounds.dof))
        self._spans = np.zeros((_BUCKETS, 2, bounds.dof))
        self._span = 0
        self._span_ends_s = 0.0
        self._anchors: deque[tuple[float, FloatArray]] = deque()
        self._repeats = False
        self._anchor_at_change = self._commanded_at_change = self._commanded
        # For longer than any lag, whenever in a period a reading may have been taken.
        self._velocities: deque[FloatArray] = deque(maxlen=math.ceil(bounds.lag_s / bounds.dt_s) + 2)

    def reset(self) -> None:
        """Forget all history, for an arm at rest."""
        self._reading = None

    def jump(self, reading: FloatArray, time_s: float) -> Stop | None:
        """Why a reading (n,), rad, is too far from the previous one, or None; call this first, on every tick.

        ``time_s`` is the loop's clock, not before that of the previous reading.
        """
        if self._reading is None:
            return None
        moved = np.abs(reading - self._reading)
        if largest(moved) <= self._slowest_jump:
            return None
        elapsed_s = time_s - self._time_s
        excess = (moved - self._jump - self._fastest * elapsed_s).tolist()
        joint = excess.index(max(excess))
        if not excess[joint] > 0.0:
            return None
        elapsed_ms = round(1000 * elapsed_s)
        return Stop(
            f"The reading of joint {self._names[joint]!r} jumped by {moved[joint]:.2g} {self._units[joint]}"
            f" in {elapsed_ms} ms: check the arm and its encoder.",
            untrusted=True,
            code="slide_jumped" if self._slides[joint] else "joint_jumped",
            parameters={**self._of(joint, "moved", float(moved[joint])), "elapsed_ms": elapsed_ms},
        )

    def follow(
        self, reading: FloatArray, velocity: FloatArray, time_s: float, *, new: bool, driven: bool
    ) -> Stop | None:
        """Add a reading; why it disagrees with the commands, or None.

        Args:
            reading: (n,), measured joint positions, rad, finite.
            velocity: (n,), the command since the reading before, rad/s.
            time_s: the loop's clock, s.
            new: whether it was measured since the reading before.
            driven: whether the arm is expected to follow its commands. An arm at rest that is not enabled may
                be moved by hand: then every reading is the anchor for the next ones.
        """
        if self._reading is None:
            self._begin(reading, time_s)
            return None
        self._integrate(velocity, time_s)
        both = _BOTH_SIGNS * reading
        reach = np.maximum.reduce(self._spans)
        anchor = both + reach[::-1]
        repeated = reading == self._reading
        self._reading, self._time_s = reading, time_s
        self._repeats = driven and True in repeated.tolist()
        if self._repeats:
            self._anchor_at_change = np.where(repeated, self._anchor_at_change, anchor)
            self._commanded_at_change = np.where(repeated, self._commanded_at_change, self._commanded)
        else:
            self._anchor_at_change, self._commanded_at_change = anchor, self._commanded
        if not driven:
            self._anchors.clear()
            self._anchors.append((time_s, anchor))
            return None
        now = both - reach
        if self._repeats:
            frozen = np.maximum.reduce(now - self._anchor_at_change)
            if new and len(self._velocities) == self._velocities.maxlen:
                directions = np.sign(self._velocities)
                ahead = directions[-1] * (self._commanded - self._commanded_at_change)[0]
                frozen = np.where(repeated & (directions == directions[-1]).all(axis=0), ahead, frozen)
            if largest(frozen) > self._freeze:
                return self._froze(int(frozen.argmax()))
        error = now - self._oldest(time_s, anchor)
        if largest(error.ravel()) > self._following:
            return self._strayed(np.maximum.reduce(error))
        return None

    def estimate(self, reading: FloatArray) -> FloatArray:
        """The positions (n,), rad, assuming that joints whose readings repeat moved as commanded.

        A reading that repeats exactly is either old or from a frozen encoder. Until `follow` can tell which,
        assume that the joint has moved: nothing that depends on the arm's position may wait for the next
        reading.
        """
        if not self._repeats:
            return reading
        return reading + (self._commanded[0] - self._commanded_at_change[0])

    def _begin(self, reading: FloatArray, time_s: float) -> None:
        self._reading, self._time_s = reading, time_s
        self._commanded = np.zeros((2, len(reading)))
        self._spans[:] = 0.0
        self._span, self._span_ends_s = 0, time_s + self._bucket_s
        self._repeats = False
        self._anchor_at_change, self._commanded_at_change = _BOTH_SIGNS * reading, self._commanded
        self._velocities.clear()
        self._anchors.clear()
        self._anchors.append((time_s, self._anchor_at_change))

    def _integrate(self, velocity: FloatArray, time_s: float) -> None:
        """Advance the commanded position and its extremes over the last ``lag_s``."""
        self._velocities.append(velocity)
        before = self._commanded
        passed_s = min(time_s - self._time_s, self._hold_s)
        self._commanded = before + (passed_s * _BOTH_SIGNS) * velocity
        span = self._spans[self._span]
        np.maximum(span, self._commanded, out=span)
        if time_s < self._span_ends_s:
            return
        ended = 1 + int((time_s - self._span_ends_s) / self._bucket_s)
        self._span_ends_s += ended * self._bucket_s
        # Bins shorter than a tick end together: the arm was moving in all of them.
        passed = self._commanded if ended == 1 else np.maximum(before, self._commanded)
        for _ in range(min(ended, _BUCKETS)):
            self._span = (self._span + 1) % _BUCKETS
            self._spans[self._span] = passed

    def _oldest(self, time_s: float, anchor: FloatArray) -> FloatArray:
        """The anchor at the start of the window; new anchors are stored at intervals."""
        anchors = self._anchors
        while len(anchors) > 1 and time_s - anchors[1][0] >= self._window_s:
            anchors.popleft()
        if time_s - anchors[-1][0] >= self._bucket_s:
            anchors.append((time_s, anchor))
        return anchors[0][1]

    def _froze(self, joint: int) -> Stop:
        return Stop(
            f"The reading of joint {self._names[joint]!r} does not change although the joint was commanded to"
            " move: check its encoder, and whether something holds the joint.",
            untrusted=True,
            code="joint_frozen",
            parameters={"joint": self._names[joint]},
        )

    def _strayed(self, error: FloatArray) -> Stop:
        joint = int(error.argmax())
        return Stop(
            f"Joint {self._names[joint]!r} does not follow its commands (it is {error[joint]:.2g}"
            f" {self._units[joint]} off): check whether something holds or pushes the arm.",
            untrusted=True,
            code="slide_astray" if self._slides[joint] else "joint_astray",
            parameters=self._of(joint, "off", float(error[joint])),
        )

    def _of(self, joint: int, what: str, amount: float) -> dict[str, str | int]:
        """A joint's name and an amount, rad or m, in whole degrees or millimetres for people to read."""
        unit, shown = ("mm", 1000 * amount) if self._slides[joint] else ("deg", math.degrees(amount))
        return {"joint": self._names[joint], f"{what}_{unit}": round(shown)}
