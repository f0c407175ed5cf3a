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

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.claims import Claim, Direction, Hypothesis, Tested, corrected_by_family
from latentarm_research.studies.shared_autonomy.cell import (
    WITH_ENTROPY,
    WITH_HELP,
    WITHOUT_HELP,
    AutonomyResult,
)
from latentarm_research.studies.shared_autonomy.measures import ARRIVED
from latentarm_research.studies.shared_autonomy.preset import Person, Preset, learner, of_fixed_expertise
from latentarm_research.studies.shared_autonomy.tables import interval
from latentarm_research.studies.statistics import one_sample, paired

MEASURE: Final = "final_state_error"

REACHED: Final = ARRIVED  # error below which people are at their goal

TRAPPED: Final = 1.0 - REACHED
"""Error above which people are at the other goal, which is 1 away: as near to it as `REACHED` means."""


MARKS: Final = {f"{mark:g}": mark for mark in (REACHED, TRAPPED)}
_REACHED, _TRAPPED = MARKS


def _claim(method: str, against: str, direction: Direction = "less") -> Claim:
    return Claim(MEASURE, (method,), (against,), direction)


HYPOTHESES: Final = (
    Hypothesis(
        "H1",
        "with shared autonomy people end nearer to their goal, at every rationality between the extremes",
        tuple(_claim(method, WITHOUT_HELP) for method in (WITH_HELP, WITH_ENTROPY)),
    ),
    Hypothesis(
        "H2",
        "people who change their mind late are trapped without the entropy and not with it",
        (
            _claim(WITH_ENTROPY, WITH_HELP),
            _claim(WITH_ENTROPY, _REACHED),
            _claim(WITH_HELP, _TRAPPED, "greater"),
        ),
    ),
    Hypothesis("H3", "people who learn end nearer with the entropy", (_claim(WITH_ENTROPY, WITH_HELP),)),
)


def people_of(preset: Preset) -> dict[str, list[Person]]:
    """Of whom each hypothesis is claimed."""
    return {
        "H1": [of_fixed_expertise(beta) for beta in preset.betas[1:-1]],
        "H2": [preset.latest_change],
        "H3": [learner(name, slope) for name, slope in preset.learners.items()],
    }


def compare_methods(results: Sequence[AutonomyResult], preset: Preset) -> list[Tested]:
    """Every claim that the results allow, by hypothesis, then by model, then by task."""
    found: dict[tuple[str, str], dict[tuple[str, str], FloatArray]] = {}
    for result in results:
        here = found.setdefault((result.cell.model, result.cell.task), {})
        here |= {(one.method, one.person.label): one.figures[MEASURE] for one in result.outcomes}
    models = list(dict.fromkeys(model for model, _ in found))
    ordered = sorted(found, key=lambda place: models.index(place[0]))
    people = people_of(preset)
    tested = [
        _test(hypothesis.name, replace(claim, tasks=(task,)), person, model, found[model, task])
        for model, task in ordered
        for hypothesis in HYPOTHESES
        for person in people[hypothesis.name]
        for claim in hypothesis.claims
    ]
    return corrected_by_family(tested)


def _test(
    hypothesis: str, claim: Claim, person: Person, model: str, errors: Mapping[tuple[str, str], FloatArray]
) -> Tested:
    """One test of errors (S, P) by method and person, without correction."""
    direction = "less" if claim.direction == "less" else "greater"
    own, name = errors[claim.subject[0], person.label], claim.against[0]
    one = Tested(hypothesis=hypothesis, claim=claim, family=model, where=person.label)
    values = own.mean(axis=1)
    if name in MARKS:
        return one.of(values, np.array([MARKS[name]]), one_sample(values, MARKS[name], direction))
    other = errors[name, person.label]
    tested = one.of(values, other.mean(axis=1), paired(values, other.mean(axis=1), direction))
    apart = interval(own).high < interval(other).low
    return replace(tested, apart=apart) if hypothesis == "H1" else tested
