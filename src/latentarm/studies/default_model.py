"""The rule by which the default model is chosen from simulated drives (docs/decisions/0031)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.errors import UserError
from latentarm.models.kind import ModelKind
from latentarm.studies.statistics import bootstrap_interval
from latentarm.types import BoolArray, FloatArray

ROUNDING: Final = 1e-9
"""Ends of intervals that differ by less are the same."""


@final
@dataclass(frozen=True, eq=False)
class Candidate:
    """A model and its drives.

    Attributes:
        kind: what the model is.
        success: (N, P), whether each of P people succeeded from each of N starts; starts and people are the
            same for all candidates.
        time_s: (N, P), how long each drive took, s; a failed one counts as its limit.
        train_s: how long the model trains, s.
    """

    kind: ModelKind
    success: BoolArray
    time_s: FloatArray
    train_s: float


@final
@dataclass(frozen=True)
class Step:
    """One step of the rule.

    Attributes:
        rule: what it asks.
        figures: what it looks at, by model.
        kept: names of the models that stay.
    """

    rule: str
    figures: Mapping[str, str]
    kept: tuple[str, ...]


def success_interval(candidate: Candidate) -> tuple[float, float]:
    """95 % bootstrap interval, over starts, of the share of people who succeed."""
    low, high = bootstrap_interval(candidate.success.mean(axis=1))
    return float(low), float(high)


def leader(candidates: Sequence[Candidate]) -> Candidate:
    """The candidate with the highest success; the first of them where several have it."""
    return max(candidates, key=lambda one: float(one.success.mean()))


def may_stay(candidate: Candidate, best: Candidate) -> bool:
    """Whether the first step keeps a candidate where another one has the highest success."""
    return success_interval(candidate)[1] >= success_interval(best)[0] - ROUNDING


_Verdict = tuple[Sequence[bool], Sequence[str]]
"""Whether each candidate stays, and the figure that says so."""


def choose(candidates: Sequence[Candidate]) -> tuple[Step, ...]:
    """Apply the rule; the last step keeps one model.

    Args:
        candidates: at least one.

    Raises:
        UserError: there are no candidates, or their drives are not the same ones.
    """
    if len({values.shape for one in candidates for values in (one.success, one.time_s)}) != 1:
        raise UserError("The rule needs models that the same people drove from the same starts.")
    steps: list[Step] = []
    kept = list(candidates)
    for rule, look in (
        ("the 95 % interval of success overlaps that of the highest", _successful),
        ("the 95 % interval of the time over the fastest's, paired, includes 1", _fast),
        ("the most holds by construction", _by_construction),
        ("trains in the least time", _soonest_trained),
    ):
        stays, figures = look(kept)
        said = {one.kind.name: figure for one, figure in zip(kept, figures, strict=True)}
        kept = [one for one, stay in zip(kept, stays, strict=True) if stay]
        steps.append(Step(rule, said, tuple(one.kind.name for one in kept)))
    return tuple(steps)


def _successful(candidates: Sequence[Candidate]) -> _Verdict:
    best = leader(candidates)
    ends = [(float(one.success.mean()), *success_interval(one)) for one in candidates]
    return (
        [may_stay(one, best) for one in candidates],
        [f"{mean:.3f} [{low:.3f}, {high:.3f}]" for mean, low, high in ends],
    )


def _fast(candidates: Sequence[Candidate]) -> _Verdict:
    log_time = [np.log(one.time_s).mean(axis=1) for one in candidates]
    fastest = min(log_time, key=lambda values: float(values.mean()))
    ends = [tuple(map(float, np.exp(bootstrap_interval(values - fastest)))) for values in log_time]
    ratios = [float(np.exp((values - fastest).mean())) for values in log_time]
    return (
        [low <= 1.0 + ROUNDING for low, _ in ends],
        [f"{ratio:.2f} [{low:.2f}, {high:.2f}]" for ratio, (low, high) in zip(ratios, ends, strict=True)],
    )


def _by_construction(candidates: Sequence[Candidate]) -> _Verdict:
    holds = [int(one.kind.rests_at_zero) + int(one.kind.reverses) for one in candidates]
    words = ("nothing", "rests", "rests and goes back")
    return [one == max(holds) for one in holds], [words[one] for one in holds]


def _soonest_trained(candidates: Sequence[Candidate]) -> _Verdict:
    train_s = [one.train_s for one in candidates]
    first = train_s.index(min(train_s))
    return [index == first for index in range(len(train_s))], [f"{one:.0f} s" for one in train_s]
