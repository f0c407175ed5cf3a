"""Randomisation tests of a condition, exact for few people: within people and between them.

Within people: a person meets the conditions in a random order, so that under no difference the two sides of
a comparison might as well have been swapped for any person. All such swaps, or many at random, say how large
the condition's t is by chance. Order, trial, task and the person's own level stay as they were (Draper and
Stoneman 1966).

Between people: under no difference the two groups might as well have been any others of the same sizes. All
of these, or many at random, say how large Welch's t is by chance; the studentised statistic also holds where
the groups vary unequally (Janssen 1997).
"""

from itertools import combinations
from math import comb
from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm_research.studies.statistics import spreads
from latentarm_research.user_studies.analysis.means import LongTable

MOST_EXACT: Final = 13  # people up to whom every swap is tried
DRAWS: Final = 9999  # swaps at random for more people
SEED: Final = 17  # of these; always the same, so that a figure is the same whenever it is computed
ROUNDING: Final = 1e-9  # two statistics closer than this, as a share, are the same


def randomisation_p(table: LongTable) -> float | None:
    """Two-sided p of the condition's effect; None for fewer than two people, or without spread."""
    people, count = table.people, len(table.value)
    if people < 2 or not spreads(table.value):
        return None
    own = (table.person[:, None] == np.arange(people)).astype(float)
    fixed = np.column_stack([own, table.covariates])
    basis = np.linalg.svd(fixed, full_matrices=False)
    kept = basis.U[:, ROUNDING * basis.S.max() < basis.S]
    left = table.value - kept @ (kept.T @ table.value)
    labels = own * table.label[:, None]
    labels = labels - kept @ (kept.T @ labels)
    dof = count - kept.shape[1] - 1
    if dof < 1 or float(np.square(labels.sum(axis=1)).sum()) < ROUNDING:
        return None
    swaps = _swaps(people)
    size = np.abs(_t(swaps, labels, left, dof))
    as_extreme = size >= size[0] * (1.0 - ROUNDING)
    return float(as_extreme.mean())


def _t(swaps: FloatArray, labels: FloatArray, left: FloatArray, dof: int) -> FloatArray:
    """The condition's t (K,) under each of K swaps."""
    product = swaps @ (labels.T @ left)
    square = np.einsum("kp,pq,kq->k", swaps, labels.T @ labels, swaps)
    explained = np.where(square > ROUNDING, np.square(product) / np.maximum(square, ROUNDING), 0.0)
    rest = np.maximum(float(left @ left) - explained, ROUNDING * float(left @ left))
    return np.sign(product) * np.sqrt(explained / rest * dof)


def _swaps(people: int) -> FloatArray:
    """Signs (K, people), that of nobody swapped first. Swapping everybody turns the sign alone."""
    if people <= MOST_EXACT:
        numbers = np.arange(2 ** (people - 1))[:, None]
        return np.where((numbers >> np.arange(people)) & 1, -1.0, 1.0)
    drawn = np.random.default_rng(SEED).choice([-1.0, 1.0], (DRAWS, people))
    return np.concatenate([np.ones((1, people)), drawn])


MOST_GROUPS: Final = 20_000
"""Ways to form the groups, up to which every one is tried: 8 and 8 people have 12,870."""


def permutation_p(subject: FloatArray, against: FloatArray) -> float | None:
    """Two-sided p of the difference of two groups (n,) and (m,) of people's means.

    None for fewer than two people on either side, or where nobody differs.
    """
    pooled = np.concatenate([subject, against])
    if min(len(subject), len(against)) < 2 or not spreads(pooled):
        return None
    size = np.abs(_welch_t(pooled - pooled.mean(), _groups(len(subject), len(pooled))))
    return float((size >= size[0] * (1.0 - ROUNDING)).mean())


def _groups(first: int, people: int) -> BoolArray:
    """Who is in the first group (K, people), that which was drawn in the study first of all."""
    if comb(people, first) <= MOST_GROUPS:
        chosen = np.array(list(combinations(range(people), first)))
        groups = np.zeros((len(chosen), people), dtype=bool)
        np.put_along_axis(groups, chosen, True, axis=1)
        return groups
    own = np.arange(people) < first
    drawn = np.random.default_rng(SEED).permuted(np.tile(own, (DRAWS, 1)), axis=1)
    return np.concatenate([own[None], drawn])


def _welch_t(values: FloatArray, groups: BoolArray) -> FloatArray:
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
