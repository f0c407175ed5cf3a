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
    # Those that fail alike are named together: first by noise, then by what they are compared with.
    noises: dict[tuple[str, str, str], list[str]] = {}
    for one in failing:
        against = one.against if one.times == 1 else f"{one.times:g} times {one.against}"
        noises.setdefault((one.condition, _relation(one), against), []).append(f"{one.noise:g}")
    others: dict[tuple[str, str, str], list[str]] = {}
    for (condition, relation, against), where in noises.items():
        others.setdefault((condition, relation, listed(where)), []).append(against)
    conditions: dict[tuple[str, str, str], list[str]] = {}
    for (condition, relation, where), against in others.items():
        conditions.setdefault((relation, listed(against), where), []).append(condition)
    reasons = "; ".join(
        f"{listed(names)} {relation} {against} (noise {where})"
        for (relation, against, where), names in conditions.items()
    )
    return f"not supported: {reasons}"


def _relation(one: Comparison) -> str:
    """That what has no statistic could not be tested."""
    return "could not be tested against" if one.p is None else "not clearly below"
