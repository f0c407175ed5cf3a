"""What the tests of the hypotheses come to: for each hypothesis and model, one short line per task."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from latentarm.experiments.shared_autonomy.hypotheses import Comparison
from latentarm.experiments.studies.pages import listed


@dataclass(frozen=True)
class Verdict:
    """What the tests say of one hypothesis with one model.

    Attributes:
        hypothesis: ``H1``, ``H2`` or ``H3``.
        model: name of the model.
        supported: whether every comparison holds.
        by_task: task -> ``supported`` or ``not supported: why``, in the tasks' order.
    """

    hypothesis: str
    model: str
    supported: bool
    by_task: Mapping[str, str]


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict]:
    """One verdict for each family of tests, model by model; a task supports where all its tests do."""
    models = dict.fromkeys(one.model for one in comparisons)
    hypotheses = dict.fromkeys(one.hypothesis for one in comparisons)
    families = [
        [one for one in comparisons if (one.hypothesis, one.model) == (hypothesis, model)]
        for model in models
        for hypothesis in hypotheses
    ]
    return [_verdict(family) for family in families if family]


def _verdict(family: Sequence[Comparison]) -> Verdict:
    tasks = dict.fromkeys(one.task for one in family)
    return Verdict(
        hypothesis=family[0].hypothesis,
        model=family[0].model,
        supported=all(one.holds for one in family),
        by_task={task: _said([one for one in family if one.task == task]) for task in tasks},
    )


def _said(tests: Sequence[Comparison]) -> str:
    """What all tests of one task come to."""
    failing = [one for one in tests if not one.holds]
    if not failing:
        return "supported"
    people: dict[str, list[str]] = {}
    for one in failing:
        people.setdefault(_relation(one), []).append(one.person)
    reasons = "; ".join(f"{relation} ({listed(where)})" for relation, where in people.items())
    return f"not supported: {reasons}"


def _relation(one: Comparison) -> str:
    """``LA+SA not clearly below LA``; that what has no statistic could not be tested."""
    against = one.against or f"{one.mean_against:g}"
    if one.p is None:
        return f"{one.method} could not be tested against {against}"
    side = {"less": "below", "greater": "above"}[one.direction]
    return f"{one.method} not clearly {side} {against}"
