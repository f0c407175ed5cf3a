"""Tests of means with effect sizes and equivalence, corrections for many tests, and intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import FloatArray

Direction = Literal["less", "greater"]

NO_SPREAD: Final = 1e-9
"""SD, in the largest figure, below which several figures are the same but for rounding."""

CONFIDENCE: Final = 0.95
TAIL: Final = (1.0 - CONFIDENCE) / 2.0


def spreads(values: FloatArray) -> bool:
    """Return whether values (n,) differ by more than rounding errors."""
    return len(values) > 1 and float(values.std(ddof=1)) > NO_SPREAD * float(np.abs(values).max())


@final
@dataclass(frozen=True)
class MeansTest:
    """A t-test of one sample, such as differences of pairs, or of two independent ones.

    SciPy's functions of distributions are called, not its tests: power draws thousands of studies.
    """

    n: int  # figures of the subject, or pairs
    n_against: int  # independent figures of the other side; 0 for one sample
    difference: float  # of the means
    se: float  # its standard error
    dof: float  # degrees of freedom of t
    d: float  # difference over the SD, of two samples over the pooled one

    @property
    def t(self) -> float:
        """The statistic."""
        return self.difference / self.se

    @property
    def p(self) -> float:
        """Two-sided."""
        return 2.0 * self.p_of("greater" if self.difference > 0.0 else "less")

    def p_of(self, direction: Direction) -> float:
        """One-sided, that the subject has less, or more."""
        from scipy.special import stdtr

        return float(stdtr(self.dof, self.t if direction == "less" else -self.t))

    def p_of_equality(self, margin: float) -> float:
        """That the means differ by less than a margin: the larger of two one-sided p (Schuirmann 1987)."""
        from scipy.special import stdtr

        return float(stdtr(self.dof, (abs(self.difference) - margin) / self.se))

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper end of the 95 % interval of the difference."""
        from scipy.special import stdtrit

        reach = self.se * float(stdtrit(self.dof, 1.0 - TAIL))
        return self.difference - reach, self.difference + reach

    @property
    def g(self) -> float | None:
        """`d` without its bias in small samples, exact (Hedges 1981); None for two figures of one sample."""
        correction = small_sample_correction(self._effect_dof)
        return None if correction is None else self.d * correction

    @property
    def effect_interval(self) -> tuple[float, float]:
        """The 95 % interval of the effect size that d and g estimate (Cumming and Finch 2001).

        From the noncentral t distribution; of two samples exact where both SDs are the same.
        """
        from scipy.special import nctdtrinc

        n, m = self.n, self.n_against
        root = float(np.sqrt(n * m / (n + m) if m else n))
        low, high = (
            float(nctdtrinc(self._effect_dof, tail, self.d * root) / root) for tail in (1.0 - TAIL, TAIL)
        )
        return low, high

    @property
    def _effect_dof(self) -> int:
        return self.n + self.n_against - (2 if self.n_against else 1)

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        low, high = self.interval
        return {
            "n": self.n,
            "n_against": self.n_against,
            "difference": self.difference,
            "low": low,
            "high": high,
            "t": self.t,
            "dof": self.dof,
            "p": self.p,
            "d": self.d,
            "g": self.g,
        }


def one_sample_test(values: FloatArray, fixed: float = 0.0) -> MeansTest | None:
    """Test figures (n,) against a fixed one; of differences of pairs this is the paired test.

    None for fewer than two figures, or where all are the same.
    """
    if not spreads(values):
        return None
    n, difference, sd = len(values), float(values.mean()) - fixed, float(values.std(ddof=1))
    return MeansTest(n, 0, difference, sd / float(np.sqrt(n)), n - 1, difference / sd)


def welch_test(subject: FloatArray, against: FloatArray) -> MeansTest | None:
    """Test two independent samples (n,) and (m,) by Welch's t (Biometrika 34:28, 1947).

    None for fewer than two figures on either side, or where neither side varies.
    """
    n, m = len(subject), len(against)
    if min(n, m) < 2 or not (spreads(subject) or spreads(against)):
        return None
    difference = float(subject.mean() - against.mean())
    variances = float(subject.var(ddof=1)), float(against.var(ddof=1))
    one, other = variances[0] / n, variances[1] / m
    share = one / (one + other)  # squares of shares cannot underflow
    dof = 1.0 / (share**2 / (n - 1) + (1.0 - share) ** 2 / (m - 1))
    pooled = ((n - 1) * variances[0] + (m - 1) * variances[1]) / (n + m - 2)
    return MeansTest(n, m, difference, float(np.sqrt(one + other)), dof, difference / float(np.sqrt(pooled)))


def small_sample_correction(dof: int) -> float | None:
    """Bias correction J of a standardised difference (Hedges 1981); None where it does not exist."""
    from scipy.special import gammaln

    if dof < 2:
        return None
    return float(np.exp(gammaln(dof / 2) - gammaln((dof - 1) / 2)) / np.sqrt(dof / 2))


LEVEL: Final = 0.05  # a test holds where p, after Holm's correction, is below this
RESAMPLES: Final = 4000
BOOTSTRAP_SEED: Final = 95  # always the same, so that a figure is the same whenever it is drawn


@dataclass(frozen=True)
class Statistic:
    """A test of two means."""

    method: str  # `Welch's t`, `one-sample t`, `paired t`, ...; empty where no test was made
    test: MeansTest | None = None  # of the difference; None where it was not made
    p: float | None = None  # None where it was not tested
    why_not: str = ""  # why no test was made; empty where one was


def compare_means(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than those of a reference (m,), on average.

    Welch's test where both sides have spread; where one has none, it is a fixed figure to the other.
    """
    if not spreads(values) and not spreads(reference):
        return Statistic("", why_not="no spread on either side")
    if not spreads(values):
        found = one_sample_test(reference, float(values.mean()))
        if found is not None:
            # The reference is the sample; the difference is that of the values.
            found = replace(found, difference=-found.difference, d=-found.d)
        return _one_sided("one-sample t", found, direction)
    if not spreads(reference):
        return one_sample(values, float(reference.mean()), direction)
    return _one_sided("Welch's t", welch_test(values, reference), direction)


def one_sample(values: FloatArray, fixed: float, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than a fixed one, on average."""
    return _one_sided("one-sample t", one_sample_test(values, fixed), direction)


def paired(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than others of the same seeds (n,), on average."""
    if len(values) < 2:
        return Statistic("", why_not="too few seeds")
    return _one_sided("paired t", one_sample_test(values - reference), direction)


def _one_sided(method: str, test: MeansTest | None, direction: Direction) -> Statistic:
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
    low, high = np.quantile(means, (TAIL, 1.0 - TAIL), axis=0)
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
