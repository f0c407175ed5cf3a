"""Tests of the paper's three hypotheses of section 8.3, on the relative errors of all runs.

H1: with abundant labelled data the alignment model learns the preference. Read as: Ideal Align has a lower
error than No Align and than Manual Align. What the paper adds, that this holds of alignments that are learned
from few answers too, is tested of All Priors.

H2: with priors, far fewer answers do. Read as: with the same few answers, each single prior and all of them
have a lower error than No Priors; and All Priors comes near to Ideal Align: its error is below `NEAR` times
that.

H3: all priors together are better than one of them. Read as: All Priors has a lower error than each.

All tests are one-sided at `LEVEL`, Welch's where both sides have spread, after Holm's correction over all
tests of one hypothesis with one model.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final

from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.conditions import (
    ALL_PRIORS,
    IDEAL,
    MANUAL,
    NO_ALIGN,
    SINGLE_PRIORS,
    WITHOUT_PRIORS,
)
from latentarm.studies.statistics import LEVEL, compare_means, holm

NEAR: Final = 1.25
"""How many times the error of Ideal Align counts as near to it."""


@dataclass(frozen=True)
class Claim:
    """One part of a hypothesis: a condition's error is lower than another's.

    Attributes:
        hypothesis: ``H1``, ``H2`` or ``H3``.
        condition: which should have less.
        against: than which.
        times: of the other's error.
    """

    hypothesis: str
    condition: str
    against: str
    times: float = 1.0


CLAIMS: Final = (
    *(Claim("H1", one, other) for one in (IDEAL, ALL_PRIORS) for other in (NO_ALIGN, MANUAL)),
    *(Claim("H2", one, WITHOUT_PRIORS) for one in (*SINGLE_PRIORS, ALL_PRIORS)),
    Claim("H2", ALL_PRIORS, IDEAL, NEAR),
    *(Claim("H3", ALL_PRIORS, one) for one in SINGLE_PRIORS),
)


@dataclass(frozen=True)
class Comparison:
    """One test.

    Attributes:
        hypothesis: ``H1``, ``H2`` or ``H3``.
        task: name of the task.
        model: name of the decoder's model.
        noise: coefficient of variation of the answers.
        condition: which should have less.
        against: than which.
        times: of the other's error.
        mean: of the condition's runs.
        mean_against: of the other's, times ``times``.
        n: runs of the condition.
        n_against: runs of the other.
        test: ``Welch``, ``one-sample``, or why there is none.
        t: its statistic, or None; below 0 where the condition has less.
        dof: degrees of freedom, or None.
        p: one-sided, before correction, or None.
        p_holm: after Holm's correction over the family, or None.
        hedges_g: effect size, above 0 where the condition has less, or None.
    """

    hypothesis: str
    task: str
    model: str
    noise: float
    condition: str
    against: str
    times: float
    mean: float
    mean_against: float
    n: int
    n_against: int
    test: str
    t: float | None = None
    dof: float | None = None
    p: float | None = None
    p_holm: float | None = None
    hedges_g: float | None = None

    @property
    def holds(self) -> bool:
        """Whether this speaks for the hypothesis. What could not be tested does not."""
        return self.p_holm is not None and self.p_holm < LEVEL

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        return {**asdict(self), "holds": self.holds}


def compare_conditions(results: Sequence[CellResult]) -> list[Comparison]:
    """Every test.

    Returns:
        By hypothesis, then by model, then in the order of the results.
    """
    comparisons: list[Comparison] = []
    for hypothesis in dict.fromkeys(claim.hypothesis for claim in CLAIMS):
        claims = [claim for claim in CLAIMS if claim.hypothesis == hypothesis]
        for model in dict.fromkeys(result.cell.model for result in results):
            here = [result for result in results if result.cell.model == model]
            family = [_test(claim, result) for result in here for claim in claims]
            corrected = holm([one.p for one in family])
            comparisons += [replace(one, p_holm=p) for one, p in zip(family, corrected, strict=True)]
    return comparisons


def _test(claim: Claim, result: CellResult) -> Comparison:
    """One test, without correction."""
    values, reference = result.errors[claim.condition], claim.times * result.errors[claim.against]
    found = compare_means(values, reference, "less")
    return Comparison(
        hypothesis=claim.hypothesis,
        task=result.cell.task,
        model=result.cell.model,
        noise=result.cell.noise,
        condition=claim.condition,
        against=claim.against,
        times=claim.times,
        mean=float(values.mean()),
        mean_against=float(reference.mean()),
        n=len(values),
        n_against=len(reference),
        **asdict(found),
    )
