"""Tests of means, corrections for many tests, and intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from latentarm.core.types import FloatArray

Direction = Literal["less", "greater"]

LEVEL: Final = 0.05
"""A test holds where p, after Holm's correction, is below this."""

NO_SPREAD: Final = 1e-9
"""SD, in the largest figure, below which several figures are the same but for rounding."""


CONFIDENCE: Final = 0.95
RESAMPLES: Final = 4000
BOOTSTRAP_SEED: Final = 95
"""Always the same, so that a figure is the same whenever it is drawn."""


def spreads(values: FloatArray) -> bool:
    """Whether figures (n,) differ by more than rounding."""
    return len(values) > 1 and float(values.std(ddof=1)) > NO_SPREAD * float(np.abs(values).max())


@dataclass(frozen=True)
class Statistic:
    """A one-sided test of two means.

    Attributes:
        test: ``Welch``, ``one-sample``, or the reason no test was run.
        t: its statistic, or None; below 0 where there is less than of the reference.
        dof: degrees of freedom, or None.
        p: one-sided, or None.
        hedges_g: effect size, above 0 where the difference has the direction that was asked for; None where
            there is no test, or no unbiased estimate (a one-sample test of two figures).
    """

    test: str
    t: float | None = None
    dof: float | None = None
    p: float | None = None
    hedges_g: float | None = None


NO_DIFFERENCE: Final = Statistic("none: no spread")


def compare_means(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than those of a reference (m,), on average.

    Welch's test where both sides have spread; where one has none, it is a fixed figure to the other.
    """
    if not spreads(values) and not spreads(reference):
        return Statistic("none: no spread on either side")
    if not spreads(values):
        # The reference is the sample then, and the direction is reversed.
        asked: Direction = "greater" if direction == "less" else "less"
        turned = one_sample(reference, float(values.mean()), asked)
        return replace(turned, t=None if turned.t is None else -turned.t)
    if not spreads(reference):
        return one_sample(values, float(reference.mean()), direction)
    return _welch(values, reference, direction)


def one_sample(values: FloatArray, fixed: float, direction: Direction) -> Statistic:
    """Test whether figures (n,) that spread are less, or greater, than a fixed one, on average.

    On differences of pairs against 0 this is the paired test.
    """
    from scipy.stats import ttest_1samp  # takes a second, and only a finished study needs it

    result = ttest_1samp(values, fixed, alternative=direction)
    d = (float(values.mean()) - fixed) / float(values.std(ddof=1))
    # As if against a sample of one: the correction is 0 for two figures and so says nothing of them.
    g = _hedges(d, len(values) + 1) if len(values) > 2 else None
    return _statistic("one-sample", result, direction, g)


def paired(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than others of the same seeds (n,), on average."""
    if len(values) < 2:
        return Statistic("none: too few seeds")
    more = values - reference
    # Of a paired test this is the one-sample test of the differences.
    return replace(one_sample(more, 0.0, direction), test="paired t") if spreads(more) else NO_DIFFERENCE


def _welch(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    from scipy.stats import ttest_ind  # takes a second, and only a finished study needs it

    result = ttest_ind(values, reference, equal_var=False, alternative=direction)
    n, m = len(values), len(reference)
    pooled = ((n - 1) * values.var(ddof=1) + (m - 1) * reference.var(ddof=1)) / (n + m - 2)
    d = float((values.mean() - reference.mean()) / np.sqrt(pooled))
    return _statistic("Welch", result, direction, _hedges(d, n + m))


def _hedges(d: float, n: int) -> float:
    """Cohen's d without its bias in small samples of n figures in all (Hedges 1981)."""
    return d * (1.0 - 3.0 / (4.0 * n - 9.0))


def _statistic(test: str, result: Any, direction: Direction, g: float | None) -> Statistic:
    """SciPy's result with an effect size that is positive in the direction that was asked for."""
    signed = g if g is None or direction == "greater" else -g
    return Statistic(test, float(result.statistic), float(result.df), float(result.pvalue), signed)


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
    draws = (
        np.random.default_rng(BOOTSTRAP_SEED).multinomial(units, np.full(units, 1.0 / units), RESAMPLES)
        / units
    )
    means = np.tensordot(draws, values, axes=1)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(means, (tail, 1.0 - tail), axis=0)
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
