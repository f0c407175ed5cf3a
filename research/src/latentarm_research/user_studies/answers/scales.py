"""Scores of scales, Cronbach's alpha with its interval, and how often options were chosen."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import TAIL
from latentarm_research.user_studies.answers.items import Answer, items_of
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.questionnaire import Scale
from latentarm_research.user_studies.record import Trial

QUESTIONNAIRE: Final = "questionnaire"  # what stands for a task in records of ratings


@final
@dataclass(frozen=True)
class Rated:
    """One scale in one condition."""

    scale: str  # name of the scale
    condition: str  # name of the condition
    n: int  # people who answered all of its items
    # of their scores, which are means of answers, reversed items turned; None without people
    mean: float | None
    sd: float | None  # of their scores; None for fewer than two
    alpha: float | None  # Cronbach's; None for fewer than two people, or without spread
    alpha_low: float | None  # lower end of its 95 % interval (Feldt 1965); None with alpha
    alpha_high: float | None  # upper end
    # answers for each point from 1 on, reversed items turned; of everybody
    counts: tuple[int, ...]


@final
@dataclass(frozen=True)
class Chosen:
    """One question with options in one condition."""

    question: str  # its name
    condition: str  # name of the condition
    n: int  # people who answered it
    counts: tuple[int, ...]  # people who chose each option


@final
@dataclass(frozen=True)
class Ratings:
    """What people's answers say."""

    rated: tuple[Rated, ...]  # every scale in every condition
    scores: tuple[Trial, ...]  # a record for each person and condition, with the scales as measures
    chosen: tuple[Chosen, ...]  # every question with options in every condition
    answers: int  # number of those on a scale

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return {
            "answers": self.answers,
            "scales": [asdict(one) for one in self.rated],
            "multiple_choice": [asdict(one) for one in self.chosen],
            "scores": [
                {"person": one.person, "condition": one.condition, "scores": dict(one.measures)}
                for one in self.scores
            ],
        }


def rate(definition: Definition, answers: Sequence[Answer], trials: Sequence[Trial]) -> Ratings:
    """Score all scales.

    A person who left out an item of a scale has no score of it in that condition.
    """
    given = {
        (one.person, one.condition, one.item): one.answer for one in answers if isinstance(one.answer, int)
    }
    people = sorted({one.person for one in answers})
    items = items_of(definition)
    scores: dict[tuple[int, str], dict[str, float]] = {}
    rated: list[Rated] = []
    for scale in definition.questionnaire:
        names = [name for name, (of, _) in items.items() if of.name == scale.name]
        turned = {
            key: _turned(scale, items[key[2]][1].reversed, points)
            for key, points in given.items()
            if key[2] in names
        }
        for condition in (one.name for one in definition.conditions):
            rows = {person: [turned.get((person, condition, name)) for name in names] for person in people}
            whole = {person: np.array(row, dtype=float) for person, row in rows.items() if None not in row}
            for person, row in whole.items():
                scores.setdefault((person, condition), {})[scale.name] = float(row.mean())
            counts = Counter(points for (_, of, _), points in turned.items() if of == condition)
            table = np.array(list(whole.values())).reshape(-1, len(names))
            rated.append(_rated(scale, condition, table, counts))
    order = {(one.person, one.condition): one.order for one in trials}
    records = tuple(
        Trial(person, condition, QUESTIONNAIRE, order[person, condition], 0, measures)
        for (person, condition), measures in sorted(scores.items())
    )
    return Ratings(tuple(rated), records, tuple(_chosen(definition, answers)), len(given))


def _chosen(definition: Definition, answers: Sequence[Answer]) -> Iterator[Chosen]:
    """Count the options of every question in every condition."""
    for question in definition.with_options:
        for condition in definition.conditions:
            given = [
                str(one.answer).split(";")
                for one in answers
                if (one.item, one.condition) == (question.name, condition.name)
            ]
            numbers = range(1, len(question.options) + 1)
            counts = tuple(sum(str(number) in one for one in given) for number in numbers)
            yield Chosen(question.name, condition.name, len(given), counts)


def cronbach_alpha(table: FloatArray) -> tuple[float, float, float] | None:
    """Cronbach's alpha of answers (n, k) of n people to k items, and its 95 % interval (Feldt 1965).

    None for fewer than two people or items, or where sums do not vary.
    """
    from scipy.special import fdtri

    people, items = table.shape
    if people < 2 or items < 2:
        return None
    total = float(table.sum(axis=1).var(ddof=1))
    if total <= 0.0:
        return None
    alpha = items / (items - 1) * (1.0 - float(table.var(axis=0, ddof=1).sum()) / total)
    one, other = people - 1, (people - 1) * (items - 1)
    low, high = (1.0 - (1.0 - alpha) * float(fdtri(one, other, share)) for share in (1.0 - TAIL, TAIL))
    return alpha, low, high


def _turned(scale: Scale, is_reversed: bool, points: int) -> int:
    return scale.points + 1 - points if is_reversed else points


def _rated(scale: Scale, condition: str, table: FloatArray, counts: Mapping[int, int]) -> Rated:
    scores = table.mean(axis=1)
    alpha = cronbach_alpha(table)
    return Rated(
        scale=scale.name,
        condition=condition,
        n=len(scores),
        mean=float(scores.mean()) if len(scores) else None,
        sd=float(scores.std(ddof=1)) if len(scores) > 1 else None,
        alpha=None if alpha is None else alpha[0],
        alpha_low=None if alpha is None else alpha[1],
        alpha_high=None if alpha is None else alpha[2],
        counts=tuple(counts.get(point, 0) for point in range(1, scale.points + 1)),
    )
