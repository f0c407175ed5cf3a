"""What the tests of all studies have in common."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, cast

import numpy as np

from latentarm.types import FloatArray

Direction = Literal["less", "greater"]

LEVEL: Final = 0.05
"""A test holds where p, after Holm's correction, is below this."""

NO_SPREAD: Final = 1e-9
"""SD, in the largest figure, below which several figures are the same but for rounding."""


def spreads(values: FloatArray) -> bool:
    """Whether figures (n,) differ by more than rounding."""
    return len(values) > 1 and float(values.std(ddof=1)) > NO_SPREAD * float(np.abs(values).max())


@dataclass(frozen=True)
class Statistic:
    """A one-sided test of two means.

    Attributes:
        test: ``Welch``, ``one-sample``, or why there is none.
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


def compare_means(values: FloatArray, reference: FloatArray, direction: Direction) -> Statistic:
    """Test whether figures (n,) are less, or greater, than those of a reference (m,), on average.

    Welch's test where both sides have spread; where one has none, it is a fixed figure to the other.
    """
    if not spreads(values) and not spreads(reference):
        return Statistic("none: no spread on either side")
    if not spreads(values):
        # The reference is the sample then, and the question is turned round.
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
    """p-values of one family after Holm's correction; None is what was not tested, and does not count."""
    from statsmodels.stats.multitest import multipletests  # takes a second, as above

    tested = [one for one in p if one is not None]
    if not tested:
        return list(p)
    corrected = iter(cast(FloatArray, multipletests(tested, alpha=LEVEL, method="holm")[1]))
    return [None if one is None else float(next(corrected)) for one in p]


def format_p(p: float | None) -> str:
    """A p-value to three places, or ``< 0.001``."""
    if p is None:
        return "not tested"
    return "< 0.001" if p < 0.001 else f"{p:.3f}"
