"""Keeping a velocity inside half-spaces ``rows @ v >= floor`` with floors that are zero or below."""

import numpy as np

from latentarm.types import FloatArray

_PASSES = 8


def slide(velocity: FloatArray, rows: FloatArray, floor: FloatArray) -> FloatArray:
    """Take out of a velocity what goes too fast towards something, and keep the rest.

    The worst half-space is projected onto, in turn, so that an arm pushed obliquely at a table slides
    along it. Because rest is in every half-space, no projection lengthens the velocity or turns it
    against what was asked; what is still too fast after a few rounds is slowed down as a whole.

    Args:
        velocity: (n,), rad/s.
        rows: (C, n), how joint velocities change C distances, m/s per rad/s.
        floor: (C,), the smallest rate of each distance, zero or below, m/s.

    Returns:
        (n,), rad/s; ``velocity`` itself where nothing is too fast.
    """
    rate = rows @ velocity
    if (rate >= floor).all():
        return velocity
    size = np.maximum((rows * rows).sum(axis=1), 1e-12)
    for _ in range(_PASSES):
        short = (floor - rate) / np.sqrt(size)
        worst = int(short.argmax())
        if short[worst] <= 1e-9:
            break
        velocity = velocity + rows[worst] * ((floor[worst] - rate[worst]) / size[worst])
        rate = rows @ velocity
    falling = rate < np.minimum(floor, -1e-12)
    if falling.any():
        velocity = velocity * float((floor[falling] / rate[falling]).min())
    return velocity


def unbent(
    velocity: FloatArray, rows: FloatArray, room: FloatArray, bend: FloatArray, time_s: float
) -> float:
    """How much of a velocity is slow enough for the paths to be taken as straight.

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
    # bend below this loses less than a nanometre in a tenth of a second
    share = (rate + root) / (np.maximum(bend, 1e-7) * time_s)
    return float(min(1.0, np.where(bend > 1e-7, share, 1.0).min(initial=1.0)))
