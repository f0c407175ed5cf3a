"""What a simulated person presses on one axis that is continuous (equation 24), drawn exactly.

``p(u) ∝ exp(-beta cost(u))`` over u in [-1, 1]. The cost is known at a few inputs and taken as linear
between two of them, so that the density integrates and its distribution function inverts in closed form: no
input is favoured by where a grid happens to lie. Within `DEAD_ZONE` of zero the person lets go of the stick:
there the cost is that of standing still.
"""

from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray

DEAD_ZONE: Final = 0.05  # inputs that are shorter let go of the stick: 5 % of all
KNOWN: Final = np.linspace(-1.0, 1.0, 11)  # (K,), the inputs whose cost is known; the middle one is 0
MOST_RATIONAL: Final = 1e12  # 1/m²; above this rationality the choice no longer changes
_MIDDLE: Final = len(KNOWN) // 2
_STARTS: Final = np.concatenate(
    [KNOWN[: _MIDDLE - 1], [KNOWN[_MIDDLE - 1], -DEAD_ZONE, DEAD_ZONE], KNOWN[_MIDDLE + 1 : -1]]
)
_ENDS: Final = np.append(_STARTS[1:], 1.0)
"""(K,), ends of the segments over which the cost is linear: the dead zone is one of them."""


def choose(
    cost: FloatArray,  # (P, K), of the inputs `KNOWN`, m²
    at_rest: FloatArray,  # (P,), of letting go, m²
    beta: FloatArray,  # (P,), rationality, zero or more, 1/m²
    chance: FloatArray,  # (P,), uniform in [0, 1): which input is drawn
) -> FloatArray:
    """Inputs (P,) of P people, in [-1, 1]; 0 for those who let go."""
    rational = np.minimum(beta, MOST_RATIONAL)[:, None]
    low, high = _segment_costs(cost, at_rest)
    least = np.minimum(low, high)
    rise = rational * np.abs(high - low)
    likely = (_ENDS - _STARTS) * np.exp(-rational * (least - least.min(axis=-1, keepdims=True))) * _mean(rise)
    below = np.cumsum(likely, axis=-1)
    drawn = chance[:, None] * below[:, -1:]
    index = np.minimum((below <= drawn).sum(axis=-1), len(_STARTS) - 1)[:, None]
    here = np.take_along_axis(likely, index, axis=-1)
    share = np.clip((drawn - np.take_along_axis(below, index, axis=-1) + here) / here, 0.0, 1.0)
    from_least = _inverse(share, np.take_along_axis(rise, index, axis=-1))
    falls: BoolArray = np.take_along_axis(high < low, index, axis=-1)
    along = np.where(falls, 1.0 - from_least, from_least)[:, 0]
    segment = index[:, 0]
    u = _STARTS[segment] + along * (_ENDS - _STARTS)[segment]
    return np.where(segment == _MIDDLE, 0.0, u)


def _segment_costs(cost: FloatArray, at_rest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Costs at both ends of every segment, each (P, K)."""
    # On the way from the known inputs next to zero to the dead zone's ends.
    towards = DEAD_ZONE / KNOWN[_MIDDLE + 1]
    before = (1.0 - towards) * cost[:, _MIDDLE] + towards * cost[:, _MIDDLE - 1]
    after = (1.0 - towards) * cost[:, _MIDDLE] + towards * cost[:, _MIDDLE + 1]
    left, right = cost[:, :_MIDDLE], cost[:, _MIDDLE + 1 :]
    low = np.concatenate([left, at_rest[:, None], after[:, None], right[:, :-1]], axis=-1)
    high = np.concatenate([left[:, 1:], before[:, None], at_rest[:, None], right], axis=-1)
    return low, high


def _mean(rise: FloatArray) -> FloatArray:
    """``∫_0^1 exp(-rise t) dt``."""
    flat = rise < 1e-9
    return np.where(flat, 1.0, -np.expm1(-rise) / np.where(flat, 1.0, rise))


def _inverse(share: FloatArray, rise: FloatArray) -> FloatArray:
    """The t in [0, 1] up to which a share of ``∫_0^1 exp(-rise t) dt`` lies."""
    flat = rise < 1e-9
    safe = np.where(flat, 1.0, rise)
    found = -np.log1p(np.minimum(share, 1.0 - 1e-16) * np.expm1(-safe)) / safe
    return np.clip(np.where(flat, share, found), 0.0, 1.0)
