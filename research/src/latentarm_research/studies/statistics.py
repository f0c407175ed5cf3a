"""One-sided tests of means, corrections for many tests, and intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies import means_test

LEVEL: Final = 0.05  # a test holds where p, after Holm's correction, is below this
RESAMPLES: Final = 4000
BOOTSTRAP_SEED: Final = 95  # always the same, so that a figure is the same whenever it is drawn


@dataclass(frozen=True)
class Statistic:
    """A test of two means."""

    method: str  # `Welch's t`, `one-sample t`, `paired t`, ...; empty where no test was made
    test: means_test.MeansTest | None = None  # of the difference; None where it was not made
    p: float | None = None  # None where it was not tested
    why_not: str = ""  # why no test was made; empty where one was


def compare_means(values: FloatArray, reference: FloatArray, direction: means_test.Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than those of a reference (m,), on average.

    Welch's test where both sides have spread; where one has none, it is a fixed figure to the other.
    """
    if not means_test.spreads(values) and not means_test.spreads(reference):
        return Statistic("", why_not="no spread on either side")
    if not means_test.spreads(values):
        found = means_test.one_sample_test(reference, float(values.mean()))
        if found is not None:
            # The reference is the sample; the difference is that of the values.
            found = replace(found, difference=-found.difference, d=-found.d)
        return _one_sided("one-sample t", found, direction)
    if not means_test.spreads(reference):
        return one_sample(values, float(reference.mean()), direction)
    return _one_sided("Welch's t", means_test.welch_test(values, reference), direction)


def one_sample(values: FloatArray, fixed: float, direction: means_test.Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than a fixed one, on average."""
    return _one_sided("one-sample t", means_test.one_sample_test(values, fixed), direction)


def paired(values: FloatArray, reference: FloatArray, direction: means_test.Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than others of the same seeds (n,), on average."""
    if len(values) < 2:
        return Statistic("", why_not="too few seeds")
    return _one_sided("paired t", means_test.one_sample_test(values - reference), direction)


def _one_sided(method: str, test: means_test.MeansTest | None, direction: means_test.Direction) -> Statistic:
    """The result of a test of one direction; None is figures without spread."""
    if test is None:
        return Statistic("", why_not="no spread")
    return Statistic(method, test, test.p_of(direction))


def holm(p: Sequence[float | None]) -> list[float | None]:
    """p-values of one family after Holm's correction (1979); None is what was not tested, and does not count.

    Not by statsmodels, which collects garbage at every call: power draws thousands of studies.
    """
    tested = np.array([one for one in p if one is not None])
    order = np.argsort(tested)
    stepped = tested[order] * np.arange(len(tested), 0, -1)
    corrected = np.empty(len(tested))
    corrected[order] = np.minimum(np.maximum.accumulate(stepped), 1.0)
    values = iter(corrected.tolist())
    return [None if one is None else next(values) for one in p]


def bootstrap_interval(
    values: FloatArray,  # (N, ...), one of N units along the first axis
) -> tuple[FloatArray, FloatArray]:
    """Ends (...) of the 95 % percentile bootstrap interval for the mean of independent units (Efron 1979).

    Every resampled mean lies between the lowest and the highest value: an interval for a probability
    stays within [0, 1] and one for a positive quantity above 0, which mean ± t SE does not.
    """
    units = len(values)
    draws = (
        np.random.default_rng(BOOTSTRAP_SEED).multinomial(units, np.full(units, 1.0 / units), RESAMPLES)
        / units
    )
    means = np.tensordot(draws, values, axes=1)
    low, high = np.quantile(means, (means_test.TAIL, 1.0 - means_test.TAIL), axis=0)
    # A mean of equal values differs from them by rounding.
    lowest, highest = values.min(axis=0), values.max(axis=0)
    return np.clip(low, lowest, highest), np.clip(high, lowest, highest)


def reach_of_interval(values: FloatArray) -> tuple[float, float]:
    """How far the interval for the mean of values (N,) reaches below and above it, as error bars want it."""
    mean, (low, high) = float(values.mean()), bootstrap_interval(values)
    return max(mean - float(low), 0.0), max(float(high) - mean, 0.0)


def format_p(p: float | None) -> str:
    """A p-value to three places, or ``< 0.001``."""
    if p is None:
        return "not tested"
    return "< 0.001" if p < 0.001 else f"{p:.3f}"
