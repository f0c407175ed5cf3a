"""A randomisation test of the condition in a model of all trials: exact for few people.

A person meets the conditions in a random order, so that under no difference the two sides of a comparison
might as well have been swapped for any person. All such swaps, or many at random, say how large the
condition's t is by chance. Order, trial, task and the person's own level stay as they were (Draper and
Stoneman 1966).
"""

from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.means_test import spreads
from latentarm_research.user_studies.analysis.long_table import LongTable

MOST_EXACT: Final = 13
"""People up to whom every swap is tried."""

DRAWS: Final = 9999
"""Swaps at random for more people."""

SEED: Final = 17
"""Of these; always the same, so that a figure is the same whenever it is computed."""

ROUNDING: Final = 1e-9
"""Two statistics closer than this, as a share, are the same."""


def randomisation_p(table: LongTable) -> float | None:
    """Two-sided p of the condition's effect.

    Returns:
        None for fewer than two people, or where the measure does not vary.
    """
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
