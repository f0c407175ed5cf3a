"""A randomisation test of two independent groups: people permuted between their conditions.

People were assigned to conditions at random, so that under no difference the groups might as well have been
any others of the same sizes. All of these, or many at random, say how large Welch's t is by chance; the
studentised statistic also holds where the two groups vary unequally (Janssen 1997).
"""

from itertools import combinations
from math import comb
from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm_research.studies.means_test import spreads
from latentarm_research.user_studies.analysis.randomisation import DRAWS, ROUNDING, SEED

MOST_EXACT: Final = 20_000
"""Ways to form the groups, up to which every one is tried: 8 and 8 people have 12,870."""


def permutation_p(subject: FloatArray, against: FloatArray) -> float | None:
    """Two-sided p of the difference of two groups (n,) and (m,) of people's means.

    Returns:
        None for fewer than two people on either side, or where nobody differs.
    """
    pooled = np.concatenate([subject, against])
    if min(len(subject), len(against)) < 2 or not spreads(pooled):
        return None
    size = np.abs(_t(pooled - pooled.mean(), _groups(len(subject), len(pooled))))
    return float((size >= size[0] * (1.0 - ROUNDING)).mean())


def _groups(first: int, people: int) -> BoolArray:
    """Who is in the first group (K, people), that which was drawn in the study first of all."""
    if comb(people, first) <= MOST_EXACT:
        chosen = np.array(list(combinations(range(people), first)))
        groups = np.zeros((len(chosen), people), dtype=bool)
        np.put_along_axis(groups, chosen, True, axis=1)
        return groups
    own = np.arange(people) < first
    drawn = np.random.default_rng(SEED).permuted(np.tile(own, (DRAWS, 1)), axis=1)
    return np.concatenate([own[None], drawn])


def _t(values: FloatArray, groups: BoolArray) -> FloatArray:
    """Welch's t (K,) of each way to form the groups."""
    means, errors = [], []
    for inside in (groups.astype(float), (~groups).astype(float)):
        count = inside.sum(axis=1)
        mean = inside @ values / count
        spread = np.maximum(inside @ np.square(values) - count * np.square(mean), 0.0) / (count - 1)
        means.append(mean)
        errors.append(spread / count)
    least = ROUNDING * float(np.square(values).mean())
    return (means[0] - means[1]) / np.sqrt(np.maximum(errors[0] + errors[1], least))
