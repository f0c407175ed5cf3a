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
from dataclasses import dataclass
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
from latentarm.studies.hypotheses import Comparison, corrected
from latentarm.studies.statistics import compare_means

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


def compare_conditions(results: Sequence[CellResult]) -> list[Comparison]:
    """Every test, by hypothesis, then by model, then in the order of the results."""
    return corrected([_test(claim, result) for result in results for claim in CLAIMS])


def _test(claim: Claim, result: CellResult) -> Comparison:
    """One test, without correction."""
    values, reference = result.errors[claim.condition], claim.times * result.errors[claim.against]
    return Comparison(
        hypothesis=claim.hypothesis,
        family=result.cell.model,
        task=result.cell.task,
        model=result.cell.model,
        measure="relative_alignment_error",
        where=f"noise {result.cell.noise:g}",
        subject=claim.condition,
        against=claim.against if claim.times == 1 else f"{claim.times:g} times {claim.against}",
        mean=float(values.mean()),
        mean_against=float(reference.mean()),
        n=len(values),
        n_against=len(reference),
    ).tested(compare_means(values, reference, "less"))
