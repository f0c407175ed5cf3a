"""Each person meets every condition: pairs of means, and orders that are balanced."""

from collections.abc import Mapping, Sequence
from typing import Final, final

import numpy as np

from latentarm.core.types import IntArray
from latentarm_research.studies.means_test import MeansTest, one_sample_test
from latentarm_research.user_studies.analysis.anova import Effect, repeated_measures
from latentarm_research.user_studies.analysis.long_table import LongTable, long_table
from latentarm_research.user_studies.analysis.means import Sides, sides
from latentarm_research.user_studies.analysis.randomisation import randomisation_p
from latentarm_research.user_studies.definition import Definition, Factor
from latentarm_research.user_studies.designs.design import StudyDesign
from latentarm_research.user_studies.hypothesis import Claim
from latentarm_research.user_studies.order import orders
from latentarm_research.user_studies.record import Trial

TOO_FEW: Final = "fewer than two people have both sides"


@final
class Within(StudyDesign):
    """Paired t, dz, and swaps of each person's two conditions."""

    def orders(self, definition: Definition, people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
        """Those of the definition in turn, or Williams designs."""
        fixed = definition.orders
        if fixed:
            return [fixed[person % len(fixed)] for person in range(people)]
        return orders([one.name for one in definition.conditions], people, rng)

    def sides(self, trials: Sequence[Trial], claim: Claim) -> Sides:
        """Of everybody who has both sides."""
        return sides(trials, claim)

    def test(self, both: Sides) -> MeansTest | None:
        """The paired t-test."""
        return one_sample_test(both.differences)

    def too_few(self, both: Sides) -> str:
        """For fewer than two pairs."""
        return TOO_FEW if len(both.people) < 2 else ""

    def table(self, trials: Sequence[Trial], claim: Claim) -> LongTable:
        """Of everybody who has trials on both sides."""
        return long_table(trials, claim, on_both=True)

    def randomisation_p(self, both: Sides, table: LongTable) -> float | None:
        """Over swaps of the two conditions of each person, in a model of all trials."""
        return randomisation_p(table)

    def effects(
        self, trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
    ) -> list[Effect]:
        """Repeated measures."""
        return repeated_measures(trials, factors, measure, tasks)

    def numbers(self, conditions: int, each: Sequence[int]) -> tuple[int, ...]:
        """The same people meet all conditions."""
        return tuple(each)

    def few_to_draw_from(self, people: Mapping[int, set[str]], conditions: int, fewest: int) -> bool:
        """Whether there are fewer people."""
        return len(people) < fewest

    def drawn(self, people: Mapping[int, set[str]], number: int, rng: np.random.Generator) -> IntArray:
        """From all people alike."""
        return rng.choice(sorted(people), number)

    def of_people(self, both: Sides, drawn: IntArray) -> Sides:
        """Of those who have both sides."""
        row = {person: index for index, person in enumerate(both.people)}
        rows = np.array([row[person] for person in drawn.tolist() if person in row], dtype=np.intp)
        numbers = tuple(range(len(rows)))
        return Sides(numbers, both.subject[rows], both.against[rows], numbers)
