"""Projections that keep a velocity from closing distances too fast."""

import math

import numpy as np

from latentarm.types import BoolArray, FloatArray

_PASSES = 12
_ENOUGH = 1e-9

_LEAN = 0.2
"""Beyond a limit, at least this share of the motion must lead away from it."""


def slide(velocity: FloatArray, rows: FloatArray, floor: FloatArray, passed: BoolArray) -> FloatArray:
    """Remove from a velocity whatever approaches something too fast, and keep the rest.

    The worst half-space ``rows @ v >= floor`` is projected onto, in turn, so that an arm pushed obliquely
    at a table slides along it. Where a limit is passed already, what is left leans away from it a little,
    because a path along a curved surface would come nearer. The result is never longer than what was
    asked for nor turned against it: where no such velocity is found, it is rest. What is still too fast
    after a few rounds is slowed down as a whole.

    Args:
        velocity: (n,), rad/s.
        rows: (C, n), how joint velocities change C distances, m/s per rad/s.
        floor: (C,), the smallest rate of each distance, zero or below, m/s.
        passed: (C,), whether the distance is too small already.

    Returns:
        (n,), rad/s; ``velocity`` itself where nothing is too fast.
    """
    rate = rows @ velocity
    some_passed = bool(passed.any())
    if not some_passed and (rate >= floor).all():
        return velocity
    norm = np.sqrt((rows * rows).sum(axis=1))
    norm = np.maximum(norm, 1e-9)
    lean = np.where(passed, 0.5 * _LEAN * norm, 0.0)
    slid = velocity
    for _ in range(_PASSES):
        short = (floor + lean * math.sqrt(slid @ slid) - rate) / norm
        worst = int(short.argmax())
        if short[worst] <= _ENOUGH:
            break
        along = slid - rows[worst] * (rate[worst] / norm[worst] ** 2)
        away = _LEAN * math.sqrt(along @ along) if passed[worst] else floor[worst] / norm[worst]
        slid = along + rows[worst] * (away / norm[worst])
        rate = rows @ slid
    if slid is velocity:
        return velocity
    if slid @ velocity <= 0.0 or (rate[passed] < 0.0).any():
        # Wedged between several things: the requested velocity may still be the way out.
        slid, rate = velocity, rows @ velocity
        if (rate[passed] <= 0.0).any():
            return np.zeros_like(velocity)
    share = min(1.0, math.sqrt((velocity @ velocity) / (slid @ slid)))
    falling = rate < np.minimum(floor, -1e-12)
    if falling.any():
        share = min(share, float((floor[falling] / rate[falling]).min()))
    return share * slid


def unbent(
    velocity: FloatArray, rows: FloatArray, room: FloatArray, bend: FloatArray, time_s: float
) -> float:
    """The share of a velocity that is slow enough to treat paths as straight.

    Over ``time_s`` at share s of the velocity a distance changes by at least ``s g t - s² c t² / 2`` with
    its rate g and its bend c. That must not use up more than the room left; where there is no room,
    the motion must lead away. The largest such share has a closed form.

    Args:
        velocity: (n,), rad/s.
        rows: (C, n), as in `slide`.
        room: (C,), distance that may still be lost, zero or more, m.
        bend: (C,), second derivative of each distance at full velocity, zero or more, m/s².
        time_s: s.

    Returns:
        The share, in [0, 1].
    """
    rate = rows @ velocity
    root = np.sqrt(rate * rate + 2.0 * bend * room)
    # A bend below this loses less than a nanometre in a tenth of a second.
    share = (rate + root) / (np.maximum(bend, 1e-7) * time_s)
    return float(min(1.0, np.where(bend > 1e-7, share, 1.0).min(initial=1.0)))
