"""The t-tests of means, each with its effect size, its intervals, and the test of equivalence."""

from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import FloatArray

Direction = Literal["less", "greater"]

NO_SPREAD: Final = 1e-9
"""SD, in the largest figure, below which several figures are the same but for rounding."""

CONFIDENCE: Final = 0.95
TAIL: Final = (1.0 - CONFIDENCE) / 2.0


def spreads(values: FloatArray) -> bool:
    """Whether figures (n,) differ by more than rounding."""
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
