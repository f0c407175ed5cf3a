"""Each person meets one condition: independent groups, assigned in balanced random blocks."""

from collections.abc import Mapping, Sequence
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm_research.studies.means_test import MeansTest, welch_test
from latentarm_research.user_studies.analysis.anova import Effect, between_people
from latentarm_research.user_studies.analysis.long_table import LongTable, long_table
from latentarm_research.user_studies.analysis.means import Sides, groups
from latentarm_research.user_studies.analysis.permutation import permutation_p
from latentarm_research.user_studies.definition import Definition, Factor
from latentarm_research.user_studies.designs.design import StudyDesign
from latentarm_research.user_studies.hypothesis import Claim
from latentarm_research.user_studies.order import assigned
from latentarm_research.user_studies.record import Trial

TOO_FEW: Final = "fewer than two people on a side"


@final
class Between(StudyDesign):
    """Welch's t, Hedges' g, and permutations of people between conditions."""

    def orders(self, definition: Definition, people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
        """One condition for each."""
        return [(name,) for name in assigned([one.name for one in definition.conditions], people, rng)]

    def sides(self, trials: Sequence[Trial], claim: Claim) -> Sides:
        """Different people on either side."""
        return groups(trials, claim)

    def test(self, both: Sides) -> MeansTest | None:
        """Welch's t-test."""
        return welch_test(both.subject, both.against)

    def too_few(self, both: Sides) -> str:
        """For fewer than two people on either side."""
        return TOO_FEW if min(len(both.subject), len(both.against)) < 2 else ""

    def table(self, trials: Sequence[Trial], claim: Claim) -> LongTable:
        """Of everybody who has trials on either side."""
        return long_table(trials, claim, on_both=False)

    def randomisation_p(self, both: Sides, table: LongTable) -> float | None:
        """Over permutations of people between the two sides, on their means."""
        return permutation_p(both.subject, both.against)

    def effects(
        self, trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
    ) -> list[Effect]:
        """Between people."""
        return between_people(trials, factors, measure, tasks)

    def numbers(self, conditions: int, each: Sequence[int]) -> tuple[int, ...]:
        """So many people for each condition."""
        return tuple(conditions * number for number in each)

    def few_to_draw_from(self, people: Mapping[int, set[str]], conditions: int, fewest: int) -> bool:
        """Whether any condition has fewer people."""
        met = _by_condition(people)
        return len(met) < conditions or min(map(len, met.values())) < fewest

    def drawn(self, people: Mapping[int, set[str]], number: int, rng: np.random.Generator) -> IntArray:
        """As many from the people of each condition."""
        met = _by_condition(people)
        each = number // len(met)
        return np.concatenate([rng.choice(met[name], each) for name in sorted(met)])

    def of_people(self, both: Sides, drawn: IntArray) -> Sides:
        """Of either side by itself."""
        subject = _taken(both.people, both.subject, drawn)
        against = _taken(both.people_against, both.against, drawn)
        people = tuple(range(len(subject) + len(against)))
        return Sides(people[: len(subject)], subject, against, people[len(subject) :])


def _taken(people: Sequence[int], means: FloatArray, drawn: IntArray) -> FloatArray:
    """Means of those drawn people who stand on a side, each as often as they were drawn."""
    row = {person: index for index, person in enumerate(people)}
    return means[np.array([row[person] for person in drawn.tolist() if person in row], dtype=np.intp)]


def _by_condition(people: Mapping[int, set[str]]) -> dict[str, list[int]]:
    """The people, in order, who met each condition."""
    met: dict[str, list[int]] = {}
    for person in sorted(people):
        for name in people[person]:
            met.setdefault(name, []).append(person)
    return met
