"""What a study claims, each claim with its test, and the statistics that the paper prints."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, final

from latentarm.core.errors import UserError

Direction = Literal["less", "greater", "equal"]


@final
@dataclass(frozen=True)
class Claim:
    """That people have less, or more, or as much of a measure under some conditions as under others.

    ``less`` and ``greater`` are tested two-sided by paired t on people's means, ``equal`` by two one-sided
    tests (TOST).

    Raises:
        UserError: a condition stands on both sides, or a margin is missing or stands where none belongs.
    """

    measure: str  # a measure of the study, or a scale of its questionnaire
    subject: tuple[str, ...]  # conditions; with several, a person's mean over them, as in a main effect
    against: tuple[str, ...]  # other conditions
    direction: Direction  # of the subject's mean, compared with that of the others
    tasks: tuple[str, ...] = ()  # whose trials count; all of the study where empty
    # for `equal`, the largest difference that does not matter, in the measure's unit
    margin: float | None = None

    def __post_init__(self) -> None:
        if not self.subject or not self.against or set(self.subject) & set(self.against):
            raise UserError(f"The claim on {self.measure} must compare some conditions with other ones.")
        if (self.direction == "equal") != (self.margin is not None):
            raise UserError(
                f"The claim on {self.measure} needs a margin where it claims equality, only there."
            )
        if self.margin is not None and not 0 < self.margin < float("inf"):
            raise UserError(f"The margin of {self.measure} must be positive and finite, not {self.margin}.")


@final
@dataclass(frozen=True)
class Hypothesis:
    """A hypothesis, held where all its claims hold after Holm's correction over the whole study."""

    name: str  # `H1`, `H2`, ...
    text: str  # in the paper's words, where it is the paper's
    claims: tuple[Claim, ...]  # what is tested


def below(measure: str, subject: str, *against: str, tasks: tuple[str, ...] = ()) -> tuple[Claim, ...]:
    """Claims that one condition has less of a measure than each of the others."""
    return tuple(Claim(measure, (subject,), (other,), "less", tasks) for other in against)


def above(measure: str, subject: str, *against: str, tasks: tuple[str, ...] = ()) -> tuple[Claim, ...]:
    """Claims that one condition has more of a measure than each of the others."""
    return tuple(Claim(measure, (subject,), (other,), "greater", tasks) for other in against)


PrintedTest = Literal["trials t", "paired t", "between F", "paired p", "share", "stars", "seconds"]
"""How a figure of the paper came about: t over trials as independent, t over people in pairs, F with the
factor taken as between people, p of a paired comparison without its statistic, a share of trials, stars in a
figure without any number, a bound on a time."""


@final
@dataclass(frozen=True)
class Printed:
    """One statistic of the paper."""

    test: PrintedTest  # how it came about
    measure: str  # a measure of the study, or a scale of its questionnaire
    subject: tuple[str, ...]  # conditions compared, as in `latentarm_research.user_studies.hypothesis.Claim`
    against: tuple[str, ...]  # with which; empty for figures of one condition
    text: str  # as the paper prints it
    # whether the subject has less than the others, in the paper; None where that is not said
    less: bool | None
    significant: bool | None  # whether the paper calls it significant; None where there is no test
    tasks: tuple[str, ...] = ()  # whose trials it is about; all where empty


WRONG: Final[Mapping[PrintedTest, str]] = {
    "trials t": "It treats trials as independent, though each person gave several: the degrees of freedom"
    " count trials instead of people, and p comes out too small.",
    "between F": "It compares the two halves of the same people's figures as if they were different people:"
    " F(1, 18) for ten people is not the within-subject F(1, 9).",
    "paired t": "The test is right for a within-subject design; no correction for several tests, no interval"
    " and no effect size is given.",
    "paired p": "Only the bound on p is given: no statistic, no correction for several tests, no effect"
    " size.",
    "share": "A share of trials is given without an interval that allows for several trials of one person.",
    "stars": "The figure has stars only: no statistic, no correction for several tests, no effect size.",
    "seconds": "Times of two people are described; nothing was tested.",
}
"""What is wrong with each, or missing from it, in one sentence."""
