"""What a study claims: hypotheses as sets of comparisons between conditions, each with its test."""

from dataclasses import dataclass
from typing import Literal, final

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
