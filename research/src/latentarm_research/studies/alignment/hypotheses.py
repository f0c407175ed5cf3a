"""Tests of the paper's three hypotheses of section 8.3, on the errors of all runs.

H1: with abundant labelled data the alignment model learns the preference. Read as: Ideal Align has a lower
error than No Align and than Manual Align. The paper adds that this also holds for alignments learned from few
answers; that is tested for All Priors.

H2: with priors, far fewer answers do. Read as: with the same few answers, each single prior and all of them
have a lower error than No Priors; and All Priors comes close to Ideal Align: its error is below `NEAR` times
that. The same is tested for Tool Space, ours, which the paper does not have.

H3: all priors together are better than one of them. Read as: All Priors has a lower error than each.

All tests are one-sided at `LEVEL`, Welch's where both sides have spread, after Holm's correction over all
tests of one hypothesis with one model.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    IDEAL,
    MANUAL,
    NO_ALIGN,
    PAPER_MODEL,
    SINGLE_PRIORS,
    TOOL_SPACE,
    WITHOUT_PRIORS,
)
from latentarm_research.studies.claims import Claim, Hypothesis, Tested, corrected_by_family
from latentarm_research.studies.statistics import compare_means

NEAR: Final = 1.25  # up to this many times the error of Ideal Align counts as close to it


NEAR_IDEAL: Final = f"{NEAR:g} times {IDEAL}"


def _below(against: str, *conditions: str) -> tuple[Claim, ...]:
    """That each condition has a lower error than another one."""
    return tuple(Claim("relative_alignment_error", (one,), (against,), "less") for one in conditions)


HYPOTHESES: Final = (
    Hypothesis(
        "H1",
        "with abundant answers the alignment learns what is meant",
        (*_below(NO_ALIGN, IDEAL, ALL_PRIORS), *_below(MANUAL, IDEAL, ALL_PRIORS)),
    ),
    Hypothesis(
        "H2",
        "with priors, far fewer answers do",
        (
            *_below(WITHOUT_PRIORS, *SINGLE_PRIORS, ALL_PRIORS),
            *_below(NEAR_IDEAL, ALL_PRIORS, TOOL_SPACE),
        ),
    ),
    Hypothesis(
        "H3",
        "all priors together are better than one of them",
        tuple(claim for one in SINGLE_PRIORS for claim in _below(one, ALL_PRIORS)),
    ),
)


def compare_conditions(results: Sequence[AlignmentErrors]) -> list[Tested]:
    """Every claim, by hypothesis, then in the order of the results."""
    return corrected_by_family(
        [
            _test(hypothesis.name, claim, result)
            for result in results
            for hypothesis in HYPOTHESES
            for claim in hypothesis.claims
        ]
    )


def _test(hypothesis: str, claim: Claim, result: AlignmentErrors) -> Tested:
    """One test, without correction."""
    errors = {**result.errors, NEAR_IDEAL: NEAR * result.errors[IDEAL]}
    values, reference = errors[claim.subject[0]], errors[claim.against[0]]
    return Tested(
        hypothesis=hypothesis,
        claim=replace(claim, tasks=(result.cell.task,)),
        family=PAPER_MODEL,
        where=f"noise {result.cell.noise:g}",
    ).of(values, reference, compare_means(values, reference, "less"))
