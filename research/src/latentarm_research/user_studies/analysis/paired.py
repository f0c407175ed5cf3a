"""Paired comparisons of people's means, with effect sizes and their intervals."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import CONFIDENCE, spreads

TAIL: Final = (1.0 - CONFIDENCE) / 2.0


@final
@dataclass(frozen=True)
class Paired:
    """A two-sided paired t-test.

    Attributes:
        n: people.
        difference: mean of the differences.
        low: lower end of its 95 % interval.
        high: upper end.
        t: the statistic.
        dof: n - 1.
        p: two-sided.
        dz: mean difference over the SD of the differences.
        g: the same without its bias in small samples (Hedges 1981).
    """

    n: int
    difference: float
    low: float
    high: float
    t: float
    dof: int
    p: float
    dz: float
    g: float


def paired_test(differences: FloatArray) -> Paired | None:
    """Test whether differences (n,) of people's means are 0 on average.

    Returns:
        None for fewer than two people, or where all differences are the same.
    """
    from scipy.special import stdtr, stdtrit  # lighter than scipy.stats: power draws thousands of studies

    if not spreads(differences):
        return None
    n, mean, sd = len(differences), float(differences.mean()), float(differences.std(ddof=1))
    dof, se = n - 1, sd / float(np.sqrt(n))
    reach = se * float(stdtrit(dof, 1.0 - TAIL))
    return Paired(
        n=n,
        difference=mean,
        low=mean - reach,
        high=mean + reach,
        t=mean / se,
        dof=dof,
        p=2.0 * float(stdtr(dof, -abs(mean / se))),
        dz=mean / sd,
        g=mean / sd * small_sample_correction(dof),
    )


def small_sample_correction(dof: int) -> float:
    """What makes a standardised difference unbiased: J of Hedges (1981), exact, for degrees of freedom."""
    from scipy.special import gammaln

    if dof < 2:
        return float("nan")
    return float(np.exp(gammaln(dof / 2) - gammaln((dof - 1) / 2)) / np.sqrt(dof / 2))


def effect_interval(dz: float, n: int) -> tuple[float, float]:
    """The 95 % interval of dz, from the noncentral t distribution (Cumming and Finch 2001).

    Args:
        dz: as observed.
        n: people, at least 2.

    Returns:
        Lower and upper end.
    """
    from scipy.special import nctdtrinc

    t, root = dz * np.sqrt(n), np.sqrt(n)
    return float(nctdtrinc(n - 1, 1.0 - TAIL, t) / root), float(nctdtrinc(n - 1, TAIL, t) / root)
