"""How close to the goal shared autonomy brings the arm, whatever the person does (equations 11 to 14).

The arm moves at ``a = (1 - alpha) phi + alpha k Σ_g b(g) (g - s)`` (equation 10) with ``‖phi‖ <= sigma_h``,
and ``V = ‖e‖² / 2`` with ``e = g* - s`` (equation 11). The sum holds ``b(g*) e``, so V falls wherever

    b(g*) ‖e‖ > delta = (1 - alpha) / (alpha k) sigma_h + others

where ``others`` is what the help towards the other goals may do; the paper has alpha = 1/2 and k = 1/s.
There are two forms of it: `furthest` (equation 14), and `known_help`, which is at most as large. Both let the
person do anything up to sigma_h; `certified_along` asks what the decoder can do against the goal, which is
less, and measures the distance in any metric.

All arguments broadcast over leading axes:

- ``sigma_h``: (...,), bound on ‖phi‖, rad/s, zero or more.
- ``state``: (..., n), rad.
- ``belief``: (..., G), probability over goals.
- ``goals``: (..., G, n), configurations, rad.
- ``goal``: (...,), index of ``g*``, the goal that the person wants.
- ``alpha``: (...,), in [0, 1]; 0 is no help, which certifies nothing.
- ``gain_per_s``: (...,), k, 1/s, positive.

Numbers that are not finite certify nothing; a number out of its range is a `UserError`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray

Others = Callable[[FloatArray, FloatArray, FloatArray, ArrayLike], FloatArray]
"""``(state, belief, goals, goal)`` to a bound (...,), rad, on what help towards the other goals may do."""

_TINY = 1e-300


def furthest(state: FloatArray, belief: FloatArray, goals: FloatArray, goal: ArrayLike) -> FloatArray:
    """``(1 - b(g*)) sigma_r`` with ``sigma_r = max ‖g - s‖``, (...,), rad (equation 14); 0 with one goal."""
    other = _is_other(goals, goal)
    return np.vecdot(belief, other) * (other * _length(goals - state[..., None, :])).max(axis=-1)


def known_help(state: FloatArray, belief: FloatArray, goals: FloatArray, goal: ArrayLike) -> FloatArray:
    """``-Σ b(g) (g - s)·e / ‖e‖`` over the other goals, (...,), rad: the robot knows where it helps to.

    Negative where help towards the other goals leads to this one too. No smaller one would do: a person who
    steers straight away from the goal at ``sigma_h`` meets it.
    """
    other = _is_other(goals, goal)
    away = goals - state[..., None, :]
    error, elsewhere = np.vecmat(~other, away), np.vecmat(belief * other, away)
    return -np.vecdot(elsewhere, error) / np.maximum(_length(error), _TINY)


def delta(
    sigma_h: ArrayLike,
    state: FloatArray,
    belief: FloatArray,
    goals: FloatArray,
    goal: ArrayLike,
    alpha: ArrayLike,
    gain_per_s: ArrayLike = 1.0,
    others: Others = furthest,
) -> FloatArray:
    """``(1 - alpha) / (alpha k) sigma_h + others``, (...,), rad: ``b(g*) ‖e‖`` must exceed it (equation 14).

    Infinite where alpha is zero.
    """
    sigma_h, alpha, gain = _checked(sigma_h, alpha, gain_per_s)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        person = np.where(alpha > 0.0, (1.0 - alpha) / (alpha * gain) * sigma_h, np.inf)
    return person + others(state, belief, goals, goal)


def certified(
    sigma_h: ArrayLike,
    state: FloatArray,
    belief: FloatArray,
    goals: FloatArray,
    goal: ArrayLike,
    alpha: ArrayLike,
    gain_per_s: ArrayLike = 1.0,
    others: Others = furthest,
) -> BoolArray:
    """Where ``dV/dt < 0`` whatever the person does, ``b(g*) ‖e‖ > delta``: the arm comes nearer to ``g*``."""
    wanted = ~_is_other(goals, goal)
    pull = np.vecdot(belief * wanted, _length(goals - state[..., None, :]))
    return pull > delta(sigma_h, state, belief, goals, goal, alpha, gain_per_s, others)


def certified_along(
    # (...,), upper bound of ``-w·phi(z, c)`` over all inputs (`Enclosure.furthest` of -w)
    most_against: FloatArray,
    direction: FloatArray,  # (..., n), w
    state: FloatArray,  # (..., n), rad
    belief: FloatArray,  # (..., G), probability over goals
    goals: FloatArray,  # (..., G, n), configurations, rad
    alpha: ArrayLike,  # (...,), in [0, 1]
    gain_per_s: ArrayLike = 1.0,  # (...,), k, 1/s, positive
) -> BoolArray:
    """Where the distance to ``g*`` shrinks whatever the person does, with decoder and help known.

    The distance is that of any constant metric, ``V = e^T M e / 2`` with M symmetric and positive definite:
    the identity for joint space (equation 11), the metric of the tools at the goal for what people see.

    Proof. ``e = g* - s`` and ``ds/dt = a``, so with ``w = M e``, by equation 10::

        dV/dt = -w·a = (1 - alpha) (-w·phi) - alpha k Σ_g b(g) w·(g - s)
              <= (1 - alpha) sup_z (-w·phi(z, c)) - alpha k Σ_g b(g) w·(g - s)

    which is below zero wherever this certifies. It is also the tightest: up to the slack of ``most_against``,
    wherever it does not certify some input makes ``dV/dt >= 0``. For M = 1 it certifies whatever `known_help`
    does, because ``sup_z (-e·phi) <= ‖e‖ sigma_h``.

    The result (...,) is false where alpha is zero or a number is not finite.
    """
    _, share, gain = _checked(0.0, alpha, gain_per_s)
    with np.errstate(over="ignore", invalid="ignore"):
        helped = (
            share * gain * np.vecdot(belief, np.vecdot(goals - state[..., None, :], direction[..., None, :]))
        )
        return (share > 0.0) & (helped > (1.0 - share) * most_against)


def _is_other(goals: FloatArray, goal: ArrayLike) -> BoolArray:
    """``G'``: which goals are not ``g*``, (..., G)."""
    index = np.asarray(goal)
    count = goals.shape[-2]
    if index.dtype.kind not in "iu" or np.count_nonzero((index < 0) | (index >= count)):
        raise UserError(f"The bound's goal must be an index from 0 to {count - 1}, not {goal}.")
    return np.arange(count) != index[..., None]


def _length(vector: FloatArray) -> FloatArray:
    """(..., n) to (...,)."""
    return np.sqrt(np.vecdot(vector, vector))


def _checked(
    sigma_h: ArrayLike, alpha: ArrayLike, gain_per_s: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The three as arrays, refused where out of range."""
    bound = np.asarray(sigma_h, dtype=np.float64)
    share = np.asarray(alpha, dtype=np.float64)
    gain = np.asarray(gain_per_s, dtype=np.float64)
    # A sigma_h that is not a number is a decoder's fault, not the caller's: it certifies nothing.
    if np.count_nonzero(~((share >= 0.0) & (share <= 1.0) & (gain > 0.0)) | (bound < 0.0)):
        raise UserError("The bound needs sigma_h of zero or more, alpha in [0, 1] and a positive gain_per_s.")
    return bound, share, gain
