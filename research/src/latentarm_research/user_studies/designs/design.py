"""The interface of a study's design: who meets which conditions, and how two sides are compared then."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from latentarm.core.types import IntArray
from latentarm_research.studies.means_test import MeansTest
from latentarm_research.user_studies.analysis.anova import Effect
from latentarm_research.user_studies.analysis.long_table import LongTable
from latentarm_research.user_studies.analysis.means import Sides
from latentarm_research.user_studies.definition import Definition, Factor
from latentarm_research.user_studies.hypothesis import Claim
from latentarm_research.user_studies.record import Trial


class StudyDesign(ABC):
    """How a study assigns conditions to people, and how it compares them."""

    @abstractmethod
    def orders(self, definition: Definition, people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
        """The conditions that each person meets, in order."""

    @abstractmethod
    def sides(self, trials: Sequence[Trial], claim: Claim) -> Sides:
        """People's means on both sides of a claim; nobody where the measure is missing."""

    @abstractmethod
    def test(self, both: Sides) -> MeansTest | None:
        """The test of the difference; None for too few people, or without spread."""

    @abstractmethod
    def too_few(self, both: Sides) -> str:
        """Why there are too few people for a test, in words; empty where there are enough."""

    @abstractmethod
    def table(self, trials: Sequence[Trial], claim: Claim) -> LongTable:
        """The trials that a claim compares, for models of all trials."""

    @abstractmethod
    def randomisation_p(self, both: Sides, table: LongTable) -> float | None:
        """Two-sided p over what the assignment of conditions might have been; None where it has no value."""

    @abstractmethod
    def effects(
        self, trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
    ) -> list[Effect]:
        """Analysis of variance of a 2 x 2 design; empty where it cannot be made."""

    @abstractmethod
    def numbers(self, conditions: int, each: Sequence[int]) -> tuple[int, ...]:
        """Numbers of people in all, from numbers of people who meet one condition."""

    @abstractmethod
    def few_to_draw_from(self, people: Mapping[int, set[str]], conditions: int, fewest: int) -> bool:
        """Whether there are fewer people to draw studies from than ``fewest``, for any condition."""

    @abstractmethod
    def drawn(self, people: Mapping[int, set[str]], number: int, rng: np.random.Generator) -> IntArray:
        """People of a study of so many, drawn with replacement."""

    @abstractmethod
    def of_people(self, both: Sides, drawn: IntArray) -> Sides:
        """The means of drawn people, each as often as they were drawn."""
