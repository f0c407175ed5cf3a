"""Tests of what the paper concludes in section 8.2, on the final state error; seeds are the units.

H1: with shared autonomy people end nearer to their goal, at every rationality between the extremes (all
methods are alike where people are perfect or at random), with entropy and without.

H2: after the latest change of mind, people end nearer with entropy than without. Without it they are trapped
at the wrong goal (an error near 1), with it they are not (an error below `REACHED`).

H3: people who learn, slowly or quickly, end nearer with entropy than without.

All tests are one-sided at `LEVEL` after Holm's correction over all tests of one hypothesis with one model.
Two methods are compared seed by seed (paired t): the same demonstrations, starts and chances, and the same
initial weights. H1 also asks that their 95 % intervals are apart.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final, Literal

import numpy as np

from latentarm.studies.shared_autonomy.cell import (
    WITH_ENTROPY,
    WITH_HELP,
    WITHOUT_HELP,
    CellResult,
)
from latentarm.studies.shared_autonomy.intervals import interval
from latentarm.studies.shared_autonomy.measures import ARRIVED
from latentarm.studies.shared_autonomy.people import Person, learner, of_fixed_expertise
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.studies.statistics import LEVEL, holm, one_sample, spreads
from latentarm.types import FloatArray

MEASURE: Final = "final_state_error"

REACHED: Final = ARRIVED
"""Error below which people are at their goal."""

TRAPPED: Final = 1.0 - REACHED
"""Error above which people are at the other goal, which is 1 away: as near to it as `REACHED` means."""

Direction = Literal["less", "greater"]


@dataclass(frozen=True)
class Comparison:
    """One test.

    Attributes:
        hypothesis: ``H1``, ``H2`` or ``H3``.
        task: name of the task.
        model: name of the model.
        person: who drove.
        method: by what.
        against: another method, or None for a fixed mark.
        direction: whether the method's error should be less or greater.
        mean: of the method's seeds.
        half_width: of the method's 95 % interval.
        mean_against: of the other's seeds, or the mark.
        half_width_against: of the other's 95 % interval, 0 for a mark.
        n: seeds.
        test: ``paired t``, ``one-sample t``, or why there is none.
        t: its statistic, or None.
        dof: degrees of freedom, or None.
        p: one-sided, before correction, or None.
        p_holm: after Holm's correction over the family, or None.
        hedges_g: effect size of the differences, above 0 where they have the direction of the hypothesis;
            None where there is no test, or no unbiased estimate (two seeds).
    """

    hypothesis: str
    task: str
    model: str
    person: str
    method: str
    against: str | None
    direction: Direction
    mean: float
    half_width: float
    mean_against: float
    half_width_against: float
    n: int
    test: str
    t: float | None = None
    dof: float | None = None
    p: float | None = None
    p_holm: float | None = None
    hedges_g: float | None = None

    @property
    def apart(self) -> bool:
        """Whether the 95 % intervals lie apart, in the direction of the hypothesis."""
        sign = 1.0 if self.direction == "less" else -1.0
        return sign * (self.mean_against - self.mean) > self.half_width + self.half_width_against

    @property
    def holds(self) -> bool:
        """Whether this speaks for the hypothesis. What could not be tested does not."""
        significant = self.p_holm is not None and self.p_holm < LEVEL
        return significant and (self.apart or self.hypothesis != "H1")

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        return {**asdict(self), "apart": self.apart, "holds": self.holds}


def compare_methods(results: Sequence[CellResult], preset: Preset) -> list[Comparison]:
    """Every test that the results of the study proper allow.

    Returns:
        By hypothesis, then by model, then by task.
    """
    errors = _errors(results)
    models = dict.fromkeys(model for _, model in errors)
    comparisons: list[Comparison] = []
    for claims in (_claims_h1(preset), _claims_h2(preset), _claims_h3(preset)):
        for model in models:
            here = {task: found for (task, name), found in errors.items() if name == model}
            family = [_test(claim, task, model, found) for task, found in here.items() for claim in claims]
            corrected = holm([one.p for one in family])
            comparisons += [replace(one, p_holm=p) for one, p in zip(family, corrected, strict=True)]
    return comparisons


@dataclass(frozen=True)
class _Claim:
    """One part of a hypothesis: a method's error against another's or against a mark, for one person."""

    hypothesis: str
    person: Person
    method: str
    against: str | float
    direction: Direction = "less"


def _claims_h1(preset: Preset) -> list[_Claim]:
    return [
        _Claim("H1", of_fixed_expertise(beta), method, WITHOUT_HELP)
        for beta in preset.betas[1:-1]
        for method in (WITH_HELP, WITH_ENTROPY)
    ]


def _claims_h2(preset: Preset) -> list[_Claim]:
    latest = preset.latest_change
    return [
        _Claim("H2", latest, WITH_ENTROPY, WITH_HELP),
        _Claim("H2", latest, WITH_ENTROPY, REACHED),
        _Claim("H2", latest, WITH_HELP, TRAPPED, "greater"),
    ]


def _claims_h3(preset: Preset) -> list[_Claim]:
    return [
        _Claim("H3", learner(name, slope), WITH_ENTROPY, WITH_HELP) for name, slope in preset.learners.items()
    ]


Errors = Mapping[tuple[str, str], FloatArray]
"""Errors of all drives (S, P) by method and person."""


def _errors(results: Iterable[CellResult]) -> dict[tuple[str, str], Errors]:
    """Errors by task and model."""
    found: dict[tuple[str, str], dict[tuple[str, str], FloatArray]] = {}
    for result in results:
        if result.cell.variant is None:
            here = found.setdefault((result.cell.task, result.cell.model), {})
            here |= {(one.method, one.person.label): one.figures[MEASURE] for one in result.outcomes}
    return dict(found)


def _test(claim: _Claim, task: str, model: str, errors: Errors) -> Comparison:
    """One test, without correction."""
    values = errors[claim.method, claim.person.label]
    fixed = isinstance(claim.against, float)
    against = np.full_like(values, claim.against) if fixed else errors[str(claim.against), claim.person.label]
    own, other = interval(values), interval(against)
    comparison = Comparison(
        hypothesis=claim.hypothesis,
        task=task,
        model=model,
        person=claim.person.label,
        method=claim.method,
        against=None if fixed else str(claim.against),
        direction=claim.direction,
        mean=own.mean,
        half_width=own.half_width,
        mean_against=other.mean,
        half_width_against=other.half_width,
        n=len(values),
        test="none: too few seeds",
    )
    return _with_statistics(comparison, values.mean(axis=1), against.mean(axis=1))


def _with_statistics(comparison: Comparison, values: FloatArray, against: FloatArray) -> Comparison:
    """The comparison with its statistic, p and effect size, from seeds (S,) of both sides."""
    if len(values) < 2:
        return comparison
    # Of a paired test this is the one-sample test of the differences.
    more = values - against
    if not spreads(more):
        return replace(comparison, test="none: no spread")
    found = one_sample(more, 0.0, comparison.direction)
    test = "one-sample t" if comparison.against is None else "paired t"
    return replace(comparison, test=test, t=found.t, dof=found.dof, p=found.p, hedges_g=found.hedges_g)
