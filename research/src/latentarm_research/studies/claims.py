"""Claims of studies, what became of each when it was tested, and the verdict on a hypothesis.

A claim is that some conditions have less, more or as much of a measure as others. Claims of one family are
corrected together by Holm's method. A hypothesis is held where all its claims hold.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final, Literal, final

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import LEVEL, MeansTest, Statistic, holm

Direction = Literal["less", "greater", "equal"]
Said = Literal["held", "not held", "could not be tested"]
Label = Callable[[str], str]  # what a page calls a name

NAMED: Final = 16  # claims that a verdict names at most; the table of claims has all of them


@final
@dataclass(frozen=True)
class Claim:
    """That there is less, or more, or as much of a measure under some conditions as under others."""

    measure: str
    """A measure of the study, or a scale of its questionnaire."""
    subject: tuple[str, ...]
    """Conditions, methods or models; with several, the mean over them, as in a main effect."""
    against: tuple[str, ...]
    """Other ones, or a fixed mark in digits."""
    direction: Direction
    """Direction of the subject's mean, compared with that of the others."""
    tasks: tuple[str, ...] = ()
    """Tasks whose figures count; all of the study where empty."""
    margin: float | None = None
    """For `equal`, the largest difference that does not matter, in the measure's unit."""

    def __post_init__(self) -> None:
        if not self.subject or not self.against or set(self.subject) & set(self.against):
            raise UserError(f"The claim on {self.measure} must compare some conditions with other ones.")
        if (self.direction == "equal") != (self.margin is not None):
            raise UserError(
                f"The claim on {self.measure} needs a margin where it claims equality, only there."
            )
        if self.margin is not None and not 0 < self.margin < float("inf"):
            raise UserError(f"The margin of {self.measure} must be positive and finite, not {self.margin}.")

    def worded(self, measure: Label, name: Label) -> str:
        """The claim in words, such as ``time: LA+SA < R``."""
        sign = {"less": "<", "greater": ">", "equal": "="}[self.direction]
        margin = f" ± {self.margin:g}" if self.margin is not None else ""
        where = f" ({', '.join(map(name, self.tasks))})" if self.tasks else ""
        subject, against = (" and ".join(map(name, side)) for side in (self.subject, self.against))
        return f"{measure(self.measure)}{where}: {subject} {sign} {against}{margin}"


@final
@dataclass(frozen=True)
class Hypothesis:
    """A hypothesis, held where all its claims hold after Holm's correction."""

    name: str
    """`H1`, `H2`, ..."""
    text: str
    """Words of the hypothesis, the paper's where it is the paper's."""
    claims: tuple[Claim, ...]
    """Claims that are tested."""


@final
@dataclass(frozen=True, kw_only=True)
class Tested:
    """The result of testing one claim."""

    hypothesis: str  # that it belongs to
    claim: Claim  # what is claimed
    family: str = ""  # which claims it is corrected with, such as those of a model; empty for all of a study
    where: str = ""  # further condition, such as the person or the noise level; empty if not needed
    n: int = 0  # figures of the subject, such as people or seeds
    n_against: int = 0  # figures of the other side; 1 for a mark
    mean: float | None = None  # of the subject's figures; None where it has none
    sd: float | None = None  # None for fewer than two figures
    mean_against: float | None = None  # of the other side, or the mark
    sd_against: float | None = None  # None for fewer than two figures
    method: str = ""  # `paired t`, `Welch's t`, `one-sample t`, `McNemar`, `TOST`; empty where not tested
    test: MeansTest | None = None  # of the difference; None where it was not made
    p: float | None = None  # of the claim's own test, before correction; None where not tested
    p_holm: float | None = None  # after Holm's correction over the family
    why_not: str = ""  # why it could not be tested; empty where it was
    apart: bool | None = None  # whether 95 % intervals lie apart as claimed; None where that is not asked

    def of(self, subject: FloatArray, against: FloatArray, statistic: Statistic) -> "Tested":
        """The same of figures (n,) and those of the other side (m,), with the result of their test."""
        (mean, sd), (mean_against, sd_against) = _spread(subject), _spread(against)
        return replace(
            self,
            n=len(subject),
            n_against=len(against),
            mean=mean,
            sd=sd,
            mean_against=mean_against,
            sd_against=sd_against,
            **vars(statistic),
        )

    @property
    def says(self) -> Said:
        """The verdict: held, not held, or could not be tested."""
        if self.p_holm is None or self.mean is None or self.mean_against is None:
            return "could not be tested"
        direction = self.claim.direction
        its_way = direction == "equal" or (self.mean < self.mean_against) == (direction == "less")
        return "held" if its_way and self.p_holm < LEVEL and self.apart is not False else "not held"

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        test = None if self.test is None else self.test.as_json()
        return {**asdict(self), "test": test, "says": self.says}


@final
@dataclass(frozen=True)
class Verdict:
    """The verdict on a hypothesis."""

    hypothesis: Hypothesis  # the hypothesis
    says: Said  # held where all claims held; not held where one did not; else it could not be tested
    why: str  # which claims did not hold or could not be tested, in words
    family: str = ""  # of claims; empty for all of a study
    task: str = ""  # on which task; empty for all


def corrected(tested: Sequence[Tested]) -> list[Tested]:
    """Claims of one family after Holm's correction."""
    return [replace(one, p_holm=p) for one, p in zip(tested, holm([one.p for one in tested]), strict=True)]


def corrected_by_family(tested: Sequence[Tested]) -> list[Tested]:
    """All claims of a study after Holm's correction: by hypothesis, then by family, then as given."""
    keys = sorted(dict.fromkeys((one.hypothesis, one.family) for one in tested), key=lambda key: key[0])
    return [
        one
        for key in keys
        for one in corrected([one for one in tested if (one.hypothesis, one.family) == key])
    ]


_FAILED: Final[Mapping[Said, str]] = {
    "not held": "do not hold",
    "could not be tested": "could not be tested",
}


def verdict_on(hypothesis: Hypothesis, tested: Sequence[Tested], measure: Label, name: Label) -> Verdict:
    """The verdict on a hypothesis from its tested claims; see `Claim.worded` for the labels."""
    if not tested:
        return Verdict(hypothesis, "could not be tested", "no measure of the study is about it")
    for says, words in _FAILED.items():
        failed = [
            one.claim.worded(measure, name)
            + "".join(f" ({part})" for part in (one.where, one.why_not) if part)
            for one in tested
            if one.says == says
        ]
        if failed:
            more = [f"{len(failed) - NAMED} more"] if len(failed) > NAMED else []
            why = f"{len(failed)} of {len(tested)} claims {words}: {'; '.join([*failed[:NAMED], *more])}"
            return Verdict(hypothesis, says, why)
    return Verdict(hypothesis, "held", f"all {len(tested)} claims hold")


def _spread(values: FloatArray) -> tuple[float | None, float | None]:
    """Mean and SD of figures (n,); None where there are too few for it."""
    return (
        float(values.mean()) if len(values) else None,
        float(values.std(ddof=1)) if len(values) > 1 else None,
    )
