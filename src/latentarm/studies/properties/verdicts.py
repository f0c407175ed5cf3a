"""What the tests of the hypotheses come to: for each family of tests, one short line per task."""

from collections.abc import Mapping, Sequence
from typing import Final

from latentarm.studies import verdicts as of_study
from latentarm.studies.pages import listed
from latentarm.studies.properties.hypotheses import Comparison
from latentarm.studies.statistics import Direction
from latentarm.studies.verdicts import Verdict
from latentarm.style import look_of

LONGEST: Final = 125
"""Characters in which a task's verdict says what failed; where that takes more, it counts what failed."""

SIDES: Final[Mapping[Direction, str]] = {"less": "below", "greater": "above"}


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict[bool]]:
    """One verdict for each hypothesis, about the paper's models (`Verdict.about`) and about further ones."""
    return of_study.verdicts(comparisons, lambda one: one.in_paper, _why_not)


def _why_not(tests: Sequence[Comparison]) -> str:
    """What failed; where that takes too many words, how much did."""
    failing = [one for one in tests if not one.holds]
    reasons = [
        _not_beyond([one for one in failing if one.p is not None]),
        _untested([one for one in failing if one.p is None]),
    ]
    said = "; ".join(filter(None, reasons))
    if len(said) <= LONGEST:
        return said
    measures = listed(one.measure for one in failing)
    return f"{len(failing)} of {len(tests)} tests do not hold, in {measures}"


def _not_beyond(failing: Sequence[Comparison]) -> str:
    """Which models are not on the hypothesis' side of which others."""
    parts: list[str] = []
    for alike in _alike(failing):
        models = listed(look_of(one.model).label for one in alike)
        verb = "is" if len({one.model for one in alike}) == 1 else "are"
        said_before = "" if parts else f" {verb} not significantly"
        parts.append(f"{models}{said_before} {SIDES[alike[0].direction]} {_others(alike)}")
    return ", nor ".join(parts)


def _untested(failing: Sequence[Comparison]) -> str:
    """Which models could not be tested against which others."""
    return "; ".join(
        f"{listed(look_of(one.model).label for one in alike)} could not be tested against {_others(alike)}"
        for alike in _alike(failing)
    )


def _alike(failing: Sequence[Comparison]) -> list[list[Comparison]]:
    """The comparisons, those together that differ in their model alone: same measure, same others."""
    others: dict[tuple[str, str], list[Comparison]] = {}
    for one in failing:
        others.setdefault((one.measure, one.model), []).append(one)
    groups: dict[tuple[str, tuple[str | None, ...]], list[Comparison]] = {}
    for (measure, _), ones in others.items():
        groups.setdefault((measure, tuple(one.against for one in ones)), []).extend(ones)
    return list(groups.values())


def _others(alike: Sequence[Comparison]) -> str:
    """``AE and VAE in controllability_m``, or the threshold in their place."""
    names = listed(look_of(one.against).label if one.against else f"{one.mean_against:g}" for one in alike)
    return f"{names} in {alike[0].measure}"
