"""Intervals for a mean that stay among the values that there can be, such as probabilities."""

from typing import Final

import numpy as np

from latentarm.types import FloatArray

CONFIDENCE: Final = 0.95
RESAMPLES: Final = 4000
SEED: Final = 95
"""Always the same, so that a figure is the same whenever it is drawn."""


def bootstrap_interval(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The 95 % percentile bootstrap interval for the mean of independent units (Efron 1979).

    Every resampled mean lies between the lowest and the highest value: an interval for a probability
    stays within [0, 1] and one for a positive quantity above 0, which mean ± t SE does not.

    Args:
        values: (N, ...), one of N units along the first axis.

    Returns:
        Lower and upper ends, (...); both the value itself for one unit.
    """
    units = len(values)
    draws = np.random.default_rng(SEED).multinomial(units, np.full(units, 1.0 / units), RESAMPLES) / units
    means = np.tensordot(draws, values, axes=1)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(means, (tail, 1.0 - tail), axis=0)
    # A mean of equal values differs from them by rounding.
    return np.clip(low, values.min(axis=0), None), np.clip(high, None, values.max(axis=0))


def reach_of_interval(values: FloatArray) -> tuple[float, float]:
    """How far the interval for the mean of values (N,) reaches below and above it, as error bars want it."""
    mean, (low, high) = float(values.mean()), bootstrap_interval(values)
    return max(mean - float(low), 0.0), max(float(high) - mean, 0.0)
