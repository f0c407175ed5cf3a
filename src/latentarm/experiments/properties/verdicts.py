"""What the tests of the hypotheses come to, in one sentence for each family."""

from collections.abc import Sequence
from dataclasses import dataclass

from latentarm.experiments.properties.hypotheses import Comparison
from latentarm.metrics.table import format_figure
from latentarm.style import look_of


@dataclass(frozen=True)
class Verdict:
    """What the tests say of one hypothesis.

    Attributes:
        hypothesis: ``H1`` or ``H2``.
        in_paper: whether it is about the paper's models or about the further ones.
        supported: whether every comparison holds.
        sentence: ``supported on ...``, ``not supported on ...: why``.
    """

    hypothesis: str
    in_paper: bool
    supported: bool
    sentence: str


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict]:
    """One verdict for each family of tests, in their order; a task supports where all its tests do."""
    families = dict.fromkeys((one.hypothesis, one.in_paper) for one in comparisons)
    return [
        _verdict([one for one in comparisons if (one.hypothesis, one.in_paper) == family])
        for family in families
    ]


def format_p(p: float | None) -> str:
    """A p-value to three places, or ``< 0.001``."""
    if p is None:
        return "not tested"
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def _verdict(family: Sequence[Comparison]) -> Verdict:
    first = family[0]
    tasks = list(dict.fromkeys(one.task for one in family))
    failing = {task: [one for one in family if one.task == task and not one.holds] for task in tasks}
    supporting = [task for task in tasks if not failing[task]]
    parts = [f"supported on {', '.join(supporting)}"] if supporting else []
    parts += [f"not supported on {task}: {_reasons(failing[task])}" for task in tasks if failing[task]]
    return Verdict(first.hypothesis, first.in_paper, supporting == tasks, "; ".join(parts))


def _reasons(failing: Sequence[Comparison]) -> str:
    """Every failing comparison, those of a model's measure together."""
    groups = dict.fromkeys((one.model, one.measure) for one in failing)
    return ", and ".join(
        _reason([one for one in failing if (one.model, one.measure) == group]) for group in groups
    )


def _reason(failing: Sequence[Comparison]) -> str:
    first = failing[0]
    side = {"less": "below", "greater": "above"}[first.direction]
    others = [look_of(one.against).label if one.against else "the threshold" for one in failing]
    figures = [
        f"{other} ({format_figure(one.mean_against, None)})"
        for other, one in zip(others, failing, strict=True)
    ]
    ours = f"{look_of(first.model).label}'s `{first.measure}` ({format_figure(first.mean, None)})"
    if all(one.p is None for one in failing):
        return f"{ours} could not be tested against {', '.join(figures)}"
    return f"{ours} is not significantly {side} {', '.join(figures)}"
