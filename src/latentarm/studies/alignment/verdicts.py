"""What the tests of the hypotheses come to: for each hypothesis and model, one short line per task."""

from collections.abc import Sequence

from latentarm.studies import verdicts as of_study
from latentarm.studies.alignment.hypotheses import Comparison
from latentarm.studies.page import listed
from latentarm.studies.verdicts import Verdict


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict[str]]:
    """One verdict for each hypothesis and model (`Verdict.about`), model by model."""
    models = list(dict.fromkeys(one.model for one in comparisons))
    by_model = sorted(comparisons, key=lambda one: models.index(one.model))
    return of_study.verdicts(by_model, lambda one: one.model, _why_not)


def _why_not(tests: Sequence[Comparison]) -> str:
    failing = [one for one in tests if not one.holds]
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
    return "; ".join(
        f"{listed(names)} {relation} {against} (noise {where})"
        for (relation, against, where), names in conditions.items()
    )


def _relation(one: Comparison) -> str:
    """That what has no statistic could not be tested."""
    return "could not be tested against" if one.p is None else "not clearly below"
