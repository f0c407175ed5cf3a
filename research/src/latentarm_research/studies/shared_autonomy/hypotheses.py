"""Tests of what the paper concludes in section 8.2, on the final state error; seeds are the units.

H1: with shared autonomy people end nearer to their goal, at every rationality between the extremes (all
methods are alike where people are perfect or at random), with entropy and without.

H2: after the latest change of mind, people end nearer with entropy than without. Without it they are trapped
at the wrong goal (an error near 1), with it they are not (an error below `REACHED`).

H3: people who learn, slowly or quickly, end nearer with entropy than without.

All tests are one-sided at `LEVEL` after Holm's correction over all tests of one hypothesis with one model.
Two methods are compared seed by seed (paired t): the same demonstrations, starts and chances, and the same
initial weights. H1 also asks that their 95 % intervals are apart.

Targets compare means and intervals of the same errors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.claims import Claim, Direction, Hypothesis, Tested, corrected_by_family
from latentarm_research.studies.shared_autonomy.cell import (
    WITH_ENTROPY,
    WITH_HELP,
    WITHOUT_HELP,
    AutonomyResult,
)
from latentarm_research.studies.shared_autonomy.measures import ARRIVED
from latentarm_research.studies.shared_autonomy.preset import Person, Preset, learner, of_fixed_expertise
from latentarm_research.studies.shared_autonomy.rows import Figure, Interval, interval
from latentarm_research.studies.statistics import one_sample, paired
from latentarm_research.studies.targets import Target

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
    """Every claim that the results of the study proper allow, by hypothesis, then by model, then by task."""
    found: dict[tuple[str, str], dict[tuple[str, str], FloatArray]] = {}
    for result in results:
        if result.cell.variant is None:
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


AT_LEAST: Final = 0.9
"""Final state error without entropy after the latest change of mind: people are trapped at the other cup."""

AT_MOST: Final = 0.1  # the same with entropy: they are at theirs


def targets(found: Sequence[Figure], preset: Preset) -> list[Target]:
    """Every target, by what is asked for, then by arm and model."""
    errors = {(one.task, one.model, one.condition): one.interval for one in found if one.measure == MEASURE}
    latest = preset.latest_change.label
    judged: list[Target] = []
    for task, model in dict.fromkeys((task, model) for task, model, _ in errors):
        where = look_of(task).label, look_of(model).label
        helped, opened = (errors[task, model, f"{method}, {latest}"] for method in (WITH_HELP, WITH_ENTROPY))
        trapped = f"{latest}: {WITH_HELP} at least {AT_LEAST:g}"
        free = f"{latest}: {WITH_ENTROPY} at most {AT_MOST:g}"
        judged.append(Target(trapped, helped.mean >= AT_LEAST, _written(helped), where))
        judged.append(Target(free, opened.mean <= AT_MOST, _written(opened), where))
        for name, slope in preset.learners.items():
            person = learner(name, slope).label
            helped, opened = (
                errors[task, model, f"{method}, {person}"] for method in (WITH_HELP, WITH_ENTROPY)
            )
            figures = f"{_written(helped)} and {_written(opened)}"
            judged.append(Target(f"{person}: intervals apart", opened.high < helped.low, figures, where))
    order = list(dict.fromkeys(one.name for one in judged))
    return sorted(judged, key=lambda one: order.index(one.name))


def _written(error: Interval) -> str:
    return f"{error.mean:.3f} ± {error.half_width:.3f}"
