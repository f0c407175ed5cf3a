"""Projections that keep a velocity from closing distances too fast."""

import daqp
import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm.safety.small import any_nonzero

_LEAN = 0.2
"""Beyond a limit, at least this share of the motion must lead away from it, where that is possible."""

_UNFELT = 1e-9  # a distance that no joint changes by more than this, in m per rad, has no direction
_ROUNDING = 1e-6  # a velocity whose share left is below this is rest
_SOFTNESS = 1e-10
"""The solver may miss half-spaces by this times their force, or it finds no way between opposite ones."""


def slide(
    velocity: FloatArray,
    limits: tuple[FloatArray, FloatArray],
    rows: FloatArray,
    floor: FloatArray,
    passed: BoolArray,
    metric: FloatArray,
) -> tuple[FloatArray, BoolArray]:
    """The nearest velocity that approaches nothing too fast.

    Rest is within the half-spaces ``rows @ v >= floor`` and the ``limits``, so there is a nearest velocity P:
    an arm that is pushed obliquely at a table slides along it. P is rest only where every velocity d within
    them leads backwards, ``d @ metric @ velocity <= 0``. Where a distance is too small already, the result
    leans away if it can, because a path along a curved surface would come nearer. The result is never longer
    than ``velocity`` nor turned against it.

    Args:
        velocity: (n,), rad/s.
        limits: lowest and highest speeds of the joints, (n,) each, with zero between them, rad/s.
        rows: (C, n), how joint velocities change C distances, m/s per rad/s.
        floor: (C,), the smallest rate of each distance, zero or below, m/s.
        passed: (C,), whether the distance is too small already.
        metric: (n, n), the squared length of d is ``d @ metric @ d``, at most ``d @ d``.

    Returns:
        (n,), rad/s, ``velocity`` itself where nothing is too fast; which of n + C limits changed it.
    """
    clipped = np.clip(velocity, *limits)
    acting = np.concatenate([clipped != velocity, passed & False])
    if not any_nonzero(passed | (rows @ clipped < floor)):
        return (clipped if any_nonzero(acting) else velocity), acting
    norm = np.maximum(np.sqrt(np.vecdot(rows, rows)), _UNFELT)
    rows, floor = rows / norm[:, None], floor / norm
    slid, acting = _nearest(velocity, limits, rows, floor, metric)
    wish = metric @ velocity
    if slid @ metric @ slid <= _ROUNDING**2 * (velocity @ wish):
        return np.zeros_like(velocity), acting
    lean = np.where(passed & (norm > _UNFELT), _LEAN * np.sqrt(slid @ slid), floor)
    leaning, leant = _nearest(slid, limits, rows, lean, metric)
    if leaning @ wish > 0.0 and not any_nonzero(rows @ leaning < np.minimum(0.5 * lean, lean) - 1e-9):
        longer = float(np.sqrt((leaning @ metric @ leaning) / (velocity @ wish)))
        slid, acting = leaning / max(1.0, longer), acting | leant
    return (slid if any_nonzero(acting) else velocity), acting


def within(velocity: FloatArray, limits: tuple[FloatArray, FloatArray], metric: FloatArray) -> FloatArray:
    """The velocity (n,) between two limits, (n,) each, whose change is the least by a metric (n, n).

    It is ``velocity`` itself if that is between them.
    """
    if not any_nonzero(np.clip(velocity, *limits) != velocity):
        return velocity
    return _nearest(velocity, limits, np.zeros((0, len(velocity))), np.zeros(0), metric)[0]


def _nearest(
    velocity: FloatArray,
    limits: tuple[FloatArray, FloatArray],
    rows: FloatArray,
    floor: FloatArray,
    metric: FloatArray,
) -> tuple[FloatArray, BoolArray]:
    """The velocity within limits and half-spaces of unit rows that is nearest, and which hold it."""
    kinds = np.repeat(np.array([0, 8], dtype=np.int32), [len(velocity), len(rows)])  # hard, soft
    nearest, _, flag, info = daqp.solve(
        metric,
        -metric @ velocity,
        rows,
        np.concatenate([limits[1], np.full(len(rows), np.inf)]),
        np.concatenate([limits[0], floor]),
        kinds,
        primal_tol=1e-10,
        rho_soft=_SOFTNESS,
    )
    if flag <= 0:
        return np.zeros_like(velocity), kinds >= 0
    return np.clip(nearest, *limits), info["lam"] != 0.0


def unbent(
    velocity: FloatArray, rows: FloatArray, room: FloatArray, bend: FloatArray, time_s: float
) -> float:
    """The share in [0, 1] of a velocity that is slow enough to treat paths as straight.

    Over ``time_s`` at share s of the velocity a distance changes by at least ``s g t - s² c t² / 2`` with its
    rate g (from ``rows``, see `slide`) and its bend c at full velocity, m/s², ≥ 0. That must not use up more
    than the ``room`` left (C,), m, > 0. The largest such share has a closed form.
    """
    rate = rows @ velocity
    root = np.sqrt(rate * rate + 2.0 * bend * room)
    # A bend below this loses less than a nanometre in a tenth of a second.
    share = (rate + root) / (np.maximum(bend, 1e-7) * time_s)
    return float(min(1.0, np.where(bend > 1e-7, share, 1.0).min(initial=1.0)))
