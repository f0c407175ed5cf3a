"""Least squares in a few unknowns between bounds, many problems at a time."""

from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray

NEWTON_STEPS: Final = 50  # at most; a convex problem within bounds needs a few
RIDGE: Final = 1e-12  # added to a curvature, relative to it
ROUNDING: Final = 1e-12  # a smaller change of z ends the search


def bounded_least_squares(
    gram: FloatArray, target: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Minimise ``z^T G z / 2 - t^T z`` for z (N, d) between two bounds, with G (N, d, d) symmetric, ≥ 0.

    Where the free minimum lies within the bounds it is the solution. Elsewhere an active-set method begins
    from it: axes that a bound holds, and those that the step would push through theirs at once, are left
    alone; the others take a Newton step as far as the first bound. A sweep of coordinate descent after each
    step lets go of axes that were held too long.
    """
    dim = target.shape[-1]
    # So that an axis that moves nothing has a solution.
    ridge = RIDGE * np.trace(gram, axis1=1, axis2=2) + np.finfo(float).tiny
    gram = gram + ridge[:, None, None] * np.eye(dim)
    z = np.array(np.linalg.solve(gram, target[..., None])[..., 0], dtype=np.float64)
    left = np.flatnonzero(((z < low) | (z > high)).any(axis=-1))
    z[left] = np.clip(z[left], low[left], high[left])
    for _ in range(NEWTON_STEPS):
        if not len(left):
            break
        at, curvature, least, most = z[left], gram[left], low[left], high[left]
        gradient = np.matvec(curvature, at) - target[left]
        held = ((at <= least) & (gradient > 0)) | ((at >= most) & (gradient < 0))
        step = _newton_step(curvature, gradient, held)
        for _ in range(dim):
            held |= ((at <= least) & (step > 0)) | ((at >= most) & (step < 0))
            step = _newton_step(curvature, gradient, held)
        room = np.where(step > 0, at - least, most - at)
        share = np.divide(room, np.abs(step), out=np.ones_like(room), where=np.abs(step) > room)
        now = np.clip(at - share.min(axis=1, keepdims=True) * step, least, most)
        for axis in range(dim):
            pull = target[left, axis] - np.vecdot(curvature[:, axis], now)
            one = now[:, axis] + pull / curvature[:, axis, axis]
            now[:, axis] = np.clip(one, least[:, axis], most[:, axis])
        z[left] = now
        left = left[np.abs(now - at).max(axis=-1) > ROUNDING]
    return z


def _newton_step(curvature: FloatArray, gradient: FloatArray, held: BoolArray) -> FloatArray:
    """The amount (N, d) to subtract from z, with the held axes left alone."""
    alone = held[:, :, None] | held[:, None]
    free = np.where(alone, 0.0, curvature) + held[:, :, None] * np.eye(held.shape[-1])
    return np.linalg.solve(free, np.where(held, 0.0, gradient)[..., None])[..., 0].astype(np.float64)
