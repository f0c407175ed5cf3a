"""Consistency and scalability: does the same z have the same effect everywhere, and more z more effect?

Section 8.1: at 25 states, for a fixed grid of z in [-1, 1], take the distance that the end-effector
travels and its direction (+1 right), and report R^2 of the best-fit line of distance times direction on z.

Not specified in the paper: each latent axis is varied alone, and one line, with an intercept, is fitted to
all states together. "Right" is defined in two ways:

- In the paper's sense, one direction in space for the whole axis: the principal direction of all its
  displacements (largest singular vector, uncentred). This penalises an axis that goes right in one state
  and left in another.
- In demonstrations that turn corners, no single direction is right everywhere, and the first measure
  penalises a conditioned axis that turns with the task. So the second figure takes "right" at each state
  to be where the axis itself leads there (from z = -1 to z = +1). It penalises motion that is not
  proportional to z, drift, and speed that differs between states.
"""

import numpy as np

from latentarm.core.types import FloatArray


def principal_direction(effects: FloatArray) -> FloatArray:
    """Unit vectors (..., 3), of arbitrary sign, along which effects (..., N, K, 3) mostly point."""
    scatter = np.einsum("...nki,...nkj->...ij", effects, effects)
    return np.linalg.eigh(scatter)[1][..., :, -1]


def own_direction(effects: FloatArray) -> FloatArray:
    """The way (..., N, 3), m, from the end of z = -1 to that of z = +1; not of unit length."""
    return effects[..., -1, :] - effects[..., 0, :]


def signed_distance(effects: FloatArray, grid: FloatArray) -> FloatArray:
    """Distance (..., N, K), m, positive along the axis' principal direction, negative against it.

    The principal direction is turned so that positive z goes with it on the whole. Effects are those of
    `axis_effects`, for the values of z in ``grid`` (K,).
    """
    right = principal_direction(effects)[..., None, :]
    signed = _distance_times_direction(effects, right)
    slope = np.einsum("...nk,k->...", signed, grid - grid.mean())
    return signed * np.where(slope < 0, -1.0, 1.0)[..., None, None]


def _distance_times_direction(effects: FloatArray, right: FloatArray) -> FloatArray:
    """Length of effects (..., N, K, 3), with the sign of their part along right (..., N or 1, 3)."""
    along = np.sum(effects * right[..., None, :], axis=-1)
    return np.sign(along) * np.linalg.norm(effects, axis=-1)


def line_fit(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least-squares line of y (..., M) on x (M,): slope (...,) and intercept (...,)."""
    centred = x - x.mean()
    slope = (y @ centred) / (centred @ centred)
    return slope, y.mean(axis=-1) - slope * x.mean()


def r_squared(x: FloatArray, y: FloatArray) -> FloatArray:
    """R^2 of the best-fit line of y (..., M) on x (M,), in [0, 1].

    A y that does not change (a latent axis that does nothing) has R^2 = 0: it is consistent with
    everything and of no use.
    """
    slope, intercept = line_fit(x, y)
    residual = np.sum((y - slope[..., None] * x - intercept[..., None]) ** 2, axis=-1)
    total = np.sum((y - y.mean(axis=-1, keepdims=True)) ** 2, axis=-1)
    # Rounding of a constant leaves a total of about (eps * level)^2 per point: that is no change.
    floor = (1e-12 * np.abs(y).max(axis=-1)) ** 2 * y.shape[-1]
    changes = total > floor
    explained = 1.0 - np.divide(residual, total, out=np.ones_like(total), where=changes)
    return np.clip(explained, 0.0, 1.0)


def consistency(effects: FloatArray, grid: FloatArray) -> FloatArray:
    """R^2 (S, d) of signed distance against z, with one "right" for the whole axis."""
    return _fit_all_states(signed_distance(effects, grid), grid)


def local_consistency(effects: FloatArray, grid: FloatArray) -> FloatArray:
    """R^2 (S, d) of signed distance against z, with each state's own "right"; the grid rises."""
    return _fit_all_states(_distance_times_direction(effects, own_direction(effects)), grid)


def _fit_all_states(signed: FloatArray, grid: FloatArray) -> FloatArray:
    """R^2 (...,) of one line through the signed distances (..., N, K) of all states."""
    z = np.broadcast_to(grid, signed.shape[-2:]).reshape(-1)
    return r_squared(z, signed.reshape(*signed.shape[:-2], -1))
