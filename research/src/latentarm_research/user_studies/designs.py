"""A study's design, within or between people: who meets which conditions, and how these are compared."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm_research.studies.claims import Claim
from latentarm_research.studies.statistics import MeansTest, one_sample_test, welch_test
from latentarm_research.user_studies.analysis.anova import Effect, between_people, repeated_measures
from latentarm_research.user_studies.analysis.means import LongTable, Sides, groups, long_table, sides
from latentarm_research.user_studies.analysis.randomisation import permutation_p, randomisation_p
from latentarm_research.user_studies.definition import Definition, Design, Factor
from latentarm_research.user_studies.record import Trial

People = Mapping[int, set[str]]  # the conditions that each person met


@final
@dataclass(frozen=True)
class StudyDesign:
    """How a study assigns conditions to people, and how it compares them."""

    # the conditions that each of so many people meets, in order
    orders: Callable[[Definition, int, np.random.Generator], list[tuple[str, ...]]]
    # people's means on both sides of a claim; nobody where the measure is missing
    sides: Callable[[Sequence[Trial], Claim], Sides]
    # of the difference; None for too few people, or without spread
    test: Callable[[Sides], MeansTest | None]
    # why there are too few people for a test, in words; empty where there are enough
    too_few: Callable[[Sides], str]
    table: Callable[[Sequence[Trial], Claim], LongTable]  # the trials that a claim compares
    # two-sided p over what the assignment of conditions might have been; None where it has no value
    randomisation_p: Callable[[Sides, LongTable], float | None]
    # analysis of variance of a 2 x 2 design; empty where it cannot be made
    effects: Callable[[Sequence[Trial], tuple[Factor, Factor], str, Sequence[str]], list[Effect]]
    # people in all, of so many conditions and so many people who meet one
    number: Callable[[int, int], int]
    # whether so many conditions have fewer people to draw studies from than that, any of them
    few_to_draw_from: Callable[[People, int, int], bool]
    # people of a study of so many, drawn with replacement
    drawn: Callable[[People, int, np.random.Generator], IntArray]
    of_people: Callable[[Sides, IntArray], Sides]  # the means of drawn people, each as often as drawn


def design_of(definition: Definition) -> StudyDesign:
    """The design of a study."""
    return DESIGNS[definition.design]


def williams(count: int) -> list[list[int]]:
    """Orders of 0 to ``count - 1`` by a Williams design (Williams, Aust. J. Sci. Res. A 2:149, 1949).

    Every condition stands at every place equally often, and follows every other one equally often. There are
    as many orders as conditions where their number is even, else twice as many.
    """
    zigzag = [place // 2 + 1 if place % 2 else (count - place // 2) % count for place in range(count)]
    square = [[(entry + shift) % count for entry in zigzag] for shift in range(count)]
    return square if count % 2 == 0 else square + [row[::-1] for row in square]


def assigned(conditions: Sequence[str], people: int, rng: np.random.Generator) -> list[str]:
    """A condition for each person: random blocks, each with every condition once.

    At any time the numbers of people differ by one at most; they are equal after whole blocks.
    """
    blocks = -(-people // len(conditions))
    places = [place for _ in range(blocks) for place in rng.permutation(len(conditions))]
    return [str(conditions[place]) for place in places[:people]]


def orders(conditions: Sequence[str], people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
    """An order for each person: whole Williams designs, the conditions and the rows of each in random order.

    The balance is complete where the number of people is a multiple of the design's rows.
    """
    found: list[tuple[str, ...]] = []
    while len(found) < people:
        names = rng.permutation(np.array(conditions, dtype=object))
        rows = williams(len(conditions))
        found += [tuple(str(names[entry]) for entry in rows[row]) for row in rng.permutation(len(rows))]
    return found[:people]


def _in_turn(definition: Definition, people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
    """The orders of the definition in turn, or Williams designs."""
    fixed = definition.orders
    if fixed:
        return [fixed[person % len(fixed)] for person in range(people)]
    return orders([one.name for one in definition.conditions], people, rng)


def _one_each(definition: Definition, people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
    return [(name,) for name in assigned([one.name for one in definition.conditions], people, rng)]


def _any_is_short(people: People, conditions: int, fewest: int) -> bool:
    met = _by_condition(people)
    return len(met) < conditions or min(map(len, met.values())) < fewest


def _as_many_of_each(people: People, number: int, rng: np.random.Generator) -> IntArray:
    met = _by_condition(people)
    each = number // len(met)
    return np.concatenate([rng.choice(met[name], each) for name in sorted(met)])


def _by_condition(people: People) -> dict[str, list[int]]:
    """The people, in order, who met each condition."""
    met: dict[str, list[int]] = {}
    for person in sorted(people):
        for name in people[person]:
            met.setdefault(name, []).append(person)
    return met


def _pairs(both: Sides, drawn: IntArray) -> Sides:
    """Of those drawn people who have both sides."""
    rows = _rows(both.people, drawn)
    numbers = tuple(range(len(rows)))
    return Sides(numbers, both.subject[rows], both.against[rows], numbers)


def _each_side(both: Sides, drawn: IntArray) -> Sides:
    """Of drawn people on either side by itself."""
    subject: FloatArray = both.subject[_rows(both.people, drawn)]
    against: FloatArray = both.against[_rows(both.people_against, drawn)]
    people = tuple(range(len(subject) + len(against)))
    return Sides(people[: len(subject)], subject, against, people[len(subject) :])


def _rows(people: Sequence[int], drawn: IntArray) -> IntArray:
    """Rows of those drawn people who stand on a side, each as often as they were drawn."""
    row = {person: index for index, person in enumerate(people)}
    return np.array([row[person] for person in drawn.tolist() if person in row], dtype=np.intp)


DESIGNS: Final[Mapping[Design, StudyDesign]] = {
    # Paired t, dz, and swaps of each person's two conditions in a model of all trials.
    "within": StudyDesign(
        orders=_in_turn,
        sides=sides,
        test=lambda both: one_sample_test(both.differences),
        too_few=lambda both: "fewer than two people have both sides" if len(both.people) < 2 else "",
        table=partial(long_table, on_both=True),
        randomisation_p=lambda _, table: randomisation_p(table),
        effects=repeated_measures,
        number=lambda _, each: each,
        few_to_draw_from=lambda people, _, fewest: len(people) < fewest,
        drawn=lambda people, number, rng: rng.choice(sorted(people), number),
        of_people=_pairs,
    ),
    # Welch's t, Hedges' g, and permutations of people between conditions, on their means.
    "between": StudyDesign(
        orders=_one_each,
        sides=groups,
        test=lambda both: welch_test(both.subject, both.against),
        too_few=lambda both: (
            "fewer than two people on a side" if min(len(both.subject), len(both.against)) < 2 else ""
        ),
        table=partial(long_table, on_both=False),
        randomisation_p=lambda both, _: permutation_p(both.subject, both.against),
        effects=between_people,
        number=lambda conditions, each: conditions * each,
        few_to_draw_from=_any_is_short,
        drawn=_as_many_of_each,
        of_people=_each_side,
    ),
}
