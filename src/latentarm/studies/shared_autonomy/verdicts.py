"""What the tests of the hypotheses come to: for each hypothesis and model, one short line per task."""

from collections.abc import Sequence

from latentarm.studies import verdicts as of_study
from latentarm.studies.pages import listed
from latentarm.studies.shared_autonomy.hypotheses import Comparison
from latentarm.studies.verdicts import Verdict


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict[str]]:
    """One verdict for each hypothesis and model (`Verdict.about`), model by model."""
    models = list(dict.fromkeys(one.model for one in comparisons))
    by_model = sorted(comparisons, key=lambda one: models.index(one.model))
    return of_study.verdicts(by_model, lambda one: one.model, _why_not)


def _why_not(tests: Sequence[Comparison]) -> str:
    failing = [one for one in tests if not one.holds]
    people: dict[str, list[str]] = {}
    for one in failing:
        people.setdefault(_relation(one), []).append(one.person)
    return "; ".join(f"{relation} ({listed(where)})" for relation, where in people.items())


def _relation(one: Comparison) -> str:
    """``LA+SA not clearly below LA``; that what has no statistic could not be tested."""
    against = one.against or f"{one.mean_against:g}"
    if one.p is None:
        return f"{one.method} could not be tested against {against}"
    side = {"less": "below", "greater": "above"}[one.direction]
    return f"{one.method} not clearly {side} {against}"
