"""Which trials and people do not count, by rules that cannot see the condition."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

from latentarm_research.user_studies.record import Trial

MOST_TRIALS: Final = 0.5  # a person of whom a larger share of trials is excluded is excluded


@final
@dataclass(frozen=True)
class Exclusion:
    """A rule that excludes a trial by one of its figures: it is not given the condition."""

    measure: str
    """Measure of the study; a trial without it stays."""
    side: Literal["less", "more"]
    """Excluded are trials with less than the limit, or with more."""
    limit: float
    """Limit in the measure's unit."""
    why: str
    """The reason, in words."""

    def excludes(self, measures: Mapping[str, float]) -> bool:
        """True if a trial with these figures does not count."""
        value = measures.get(self.measure)
        if value is None:
            return False
        return value < self.limit if self.side == "less" else value > self.limit


@final
@dataclass(frozen=True)
class Excluded:
    """What does not count."""

    trials: tuple[tuple[int, str], ...]  # index of each excluded trial with the reason
    people: tuple[int, ...]  # numbers of the people who do not count at all


def counted(rules: Sequence[Exclusion], trials: Sequence[Trial]) -> tuple[list[Trial], Excluded]:
    """The trials that count, and what does not."""
    gone = {
        index: next(rule.why for rule in rules if rule.excludes(trial.measures))
        for index, trial in enumerate(trials)
        if any(rule.excludes(trial.measures) for rule in rules)
    }
    had = Counter(trial.person for trial in trials)
    lost = Counter(trials[index].person for index in gone)
    people = tuple(sorted(person for person, count in lost.items() if count > MOST_TRIALS * had[person]))
    kept = [trial for index, trial in enumerate(trials) if index not in gone and trial.person not in people]
    return kept, Excluded(tuple(gone.items()), people)
