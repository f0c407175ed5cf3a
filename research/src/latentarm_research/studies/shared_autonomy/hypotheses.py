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
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.hypotheses import Comparison, corrected
from latentarm_research.studies.means_test import Direction
from latentarm_research.studies.shared_autonomy.cell import (
    WITH_ENTROPY,
    WITH_HELP,
    WITHOUT_HELP,
    AutonomyResult,
)
from latentarm_research.studies.shared_autonomy.measures import ARRIVED
from latentarm_research.studies.shared_autonomy.preset import Person, Preset, learner, of_fixed_expertise
from latentarm_research.studies.shared_autonomy.rows import Figure, Interval, interval
from latentarm_research.studies.statistics import paired
from latentarm_research.studies.targets import Target

MEASURE: Final = "final_state_error"

REACHED: Final = ARRIVED  # error below which people are at their goal

TRAPPED: Final = 1.0 - REACHED
"""Error above which people are at the other goal, which is 1 away: as near to it as `REACHED` means."""


@dataclass(frozen=True)
class MethodClaim:
    """One part of a hypothesis: a method's error against another's or against a mark, for one person."""

    hypothesis: str
    person: Person
    method: str
    against: str | float
    direction: Direction = "less"


def claims(preset: Preset) -> list[MethodClaim]:
    """All parts of H1, H2 and H3."""
    latest = preset.latest_change
    return [
        *(
            MethodClaim("H1", of_fixed_expertise(beta), method, WITHOUT_HELP)
            for beta in preset.betas[1:-1]
            for method in (WITH_HELP, WITH_ENTROPY)
        ),
        MethodClaim("H2", latest, WITH_ENTROPY, WITH_HELP),
        MethodClaim("H2", latest, WITH_ENTROPY, REACHED),
        MethodClaim("H2", latest, WITH_HELP, TRAPPED, "greater"),
        *(
            MethodClaim("H3", learner(name, slope), WITH_ENTROPY, WITH_HELP)
            for name, slope in preset.learners.items()
        ),
    ]


def compare_methods(results: Sequence[AutonomyResult], preset: Preset) -> list[Comparison]:
    """Every test that the results of the study proper allow, by hypothesis, then by model, then by task."""
    found: dict[tuple[str, str], dict[tuple[str, str], FloatArray]] = {}
    for result in results:
        if result.cell.variant is None:
            here = found.setdefault((result.cell.model, result.cell.task), {})
            here |= {(one.method, one.person.label): one.figures[MEASURE] for one in result.outcomes}
    models = list(dict.fromkeys(model for model, _ in found))
    ordered = sorted(found, key=lambda place: models.index(place[0]))
    tests = [_test(claim, *place, found[place]) for place in ordered for claim in claims(preset)]
    return corrected(tests)


def _test(
    claim: MethodClaim, model: str, task: str, errors: Mapping[tuple[str, str], FloatArray]
) -> Comparison:
    """One test of errors (S, P) by method and person, without correction."""
    values = errors[claim.method, claim.person.label]
    mark = None if isinstance(claim.against, str) else np.full_like(values, claim.against)
    against = errors[str(claim.against), claim.person.label] if mark is None else mark
    own, other = interval(values), interval(against)
    statistic = paired(values.mean(axis=1), against.mean(axis=1), claim.direction)
    if mark is not None:
        statistic = replace(statistic, test=statistic.test.replace("paired", "one-sample"))
    return Comparison(
        hypothesis=claim.hypothesis,
        family=model,
        task=task,
        model=model,
        measure=MEASURE,
        where=claim.person.label,
        subject=claim.method,
        against=str(claim.against) if mark is None else None,
        direction=claim.direction,
        mean=own.mean,
        half_width=own.half_width,
        mean_against=other.mean,
        half_width_against=other.half_width,
        n=len(values),
        n_against=len(values) if mark is None else 1,
        must_be_apart=claim.hypothesis == "H1",
    ).tested(statistic)


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
