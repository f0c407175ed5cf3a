"""What the tests of all studies have in common."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
    import pingouin  # takes a second, and only a finished study needs it

    if not spreads(values) and not spreads(reference):
        return Statistic("none: no spread on either side")
    # The side with spread is the sample; where that is the reference, the question is turned round.
    turned = not spreads(values)
    sample, other = (reference, values) if turned else (values, reference)
    welch = spreads(other)
    tested_against = other if welch else float(other.mean())
    asked = {"less": "greater", "greater": "less"}[direction] if turned else direction
    ttest = cast(Callable[..., Any], pingouin.ttest)
    effect = cast(Callable[..., float], pingouin.compute_effsize)
    row = ttest(sample, tested_against, correction=True, alternative=asked).iloc[0]
    # Positive means "as the hypothesis has it": two reversals cancel.
    sign = (-1.0 if turned else 1.0) * (1.0 if direction == "greater" else -1.0)
    g = sign * effect(sample, tested_against, eftype="hedges") if welch or len(sample) > 2 else None
    return Statistic(
        test="Welch" if welch else "one-sample",
        t=float(row["T"]) * (-1.0 if turned else 1.0),
        dof=float(row["dof"]),
        p=float(row["p_val"]),
        hedges_g=g,
    )


def holm(p: Sequence[float | None]) -> list[float | None]:
    """p-values of one family after Holm's correction; None is what was not tested, and does not count."""
    import pingouin  # takes a second, and only a finished study needs it

    tested = [one for one in p if one is not None]
    if not tested:
        return list(p)
    multicomp = cast(Callable[..., tuple[Any, FloatArray]], pingouin.multicomp)
    corrected = iter(multicomp(np.array(tested), alpha=LEVEL, method="holm")[1])
    return [None if one is None else float(next(corrected)) for one in p]


def format_p(p: float | None) -> str:
    """A p-value to three places, or ``< 0.001``."""
    if p is None:
        return "not tested"
    return "< 0.001" if p < 0.001 else f"{p:.3f}"
