"""Comparisons of two independent groups of people, with effect sizes and their intervals."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import spreads
from latentarm_research.user_studies.analysis.paired import TAIL, small_sample_correction


@final
@dataclass(frozen=True)
class Welch:
    """Welch's two-sided t-test (Biometrika 34:28, 1947).

    Attributes:
        n: people on the subject's side.
        n_against: on the other.
        difference: of the two means.
        low: lower end of its 95 % interval.
        high: upper end.
        t: the statistic.
        dof: by Welch and Satterthwaite, not a whole number.
        p: two-sided.
        d: difference over the pooled SD.
        g: the same without its bias in small samples (Hedges 1981).
    """

    n: int
    n_against: int
    difference: float
    low: float
    high: float
    t: float
    dof: float
    p: float
    d: float
    g: float


def welch_test(subject: FloatArray, against: FloatArray) -> Welch | None:
    """Test whether two groups (n,) and (m,) of people's means have the same mean.

    Returns:
        None for fewer than two people on either side, or where neither side varies.
    """
    from scipy.special import stdtr, stdtrit  # lighter than scipy.stats: power draws thousands of studies

    if not _tests(subject, against):
        return None
    difference = float(subject.mean() - against.mean())
    se, dof = _error(subject, against)
    reach = se * float(stdtrit(dof, 1.0 - TAIL))
    d = standardised(subject, against)
    n, m = len(subject), len(against)
    return Welch(
        n=n,
        n_against=m,
        difference=difference,
        low=difference - reach,
        high=difference + reach,
        t=difference / se,
        dof=dof,
        p=2.0 * float(stdtr(dof, -abs(difference / se))),
        d=d,
        g=d * small_sample_correction(n + m - 2),
    )


def welch_equivalence(subject: FloatArray, against: FloatArray, margin: float) -> float | None:
    """P of the claim that two groups' means differ by less than a margin (Schuirmann 1987), by Welch's t.

    Returns:
        The larger p of the two one-sided tests; None where `welch_test` has none.
    """
    from scipy.special import stdtr

    if not _tests(subject, against):
        return None
    difference = float(subject.mean() - against.mean())
    se, dof = _error(subject, against)
    return float(stdtr(dof, (abs(difference) - margin) / se))


def standardised(subject: FloatArray, against: FloatArray) -> float:
    """Difference of the means of two groups (n,) and (m,) over their pooled SD."""
    n, m = len(subject), len(against)
    pooled = ((n - 1) * subject.var(ddof=1) + (m - 1) * against.var(ddof=1)) / (n + m - 2)
    return float((subject.mean() - against.mean()) / np.sqrt(pooled))


def group_effect_interval(subject: FloatArray, against: FloatArray) -> tuple[float, float]:
    """The 95 % interval of the standardised difference, from the noncentral t (Cumming and Finch 2001).

    It is that of the population, which d and g both estimate; exact where the two SDs are the same.

    Args:
        subject: (n,), n at least 2.
        against: (m,), m at least 2.

    Returns:
        Lower and upper end.
    """
    from scipy.special import nctdtrinc

    n, m = len(subject), len(against)
    root = np.sqrt(n * m / (n + m))
    t = standardised(subject, against) * root
    low, high = (float(nctdtrinc(n + m - 2, tail, t) / root) for tail in (1.0 - TAIL, TAIL))
    return low, high


def _tests(subject: FloatArray, against: FloatArray) -> bool:
    return min(len(subject), len(against)) > 1 and (spreads(subject) or spreads(against))


def _error(subject: FloatArray, against: FloatArray) -> tuple[float, float]:
    """Standard error of the difference, and its degrees of freedom."""
    one, other = (float(side.var(ddof=1)) / len(side) for side in (subject, against))
    share = one / (one + other)  # squares of shares cannot underflow
    dof = 1.0 / (share**2 / (len(subject) - 1) + (1.0 - share) ** 2 / (len(against) - 1))
    return float(np.sqrt(one + other)), dof
