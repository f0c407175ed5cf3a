"""What the tests of the hypotheses come to: for each hypothesis and model, one short line per task."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from latentarm.experiments.alignment.hypotheses import Comparison
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
    families: dict[tuple[str, str], list[Comparison]] = {}
    for model in dict.fromkeys(one.model for one in comparisons):
        for one in comparisons:
            if one.model == model:
                families.setdefault((model, one.hypothesis), []).append(one)
    return [_verdict(family) for family in families.values()]


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
    noises: dict[str, list[str]] = {}
    for one in failing:
        noises.setdefault(_relation(one), []).append(f"{one.noise:g}")
    reasons = "; ".join(f"{relation} (noise {listed(where)})" for relation, where in noises.items())
    return f"not supported: {reasons}"


def _relation(one: Comparison) -> str:
    """``All Priors not clearly below Manual Align``; that what has no statistic could not be tested."""
    against = one.against if one.times == 1 else f"{one.times:g} times {one.against}"
    if one.p is None:
        return f"{one.condition} could not be tested against {against}"
    return f"{one.condition} not clearly below {against}"
