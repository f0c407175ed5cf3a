"""The tests of a study's claims, corrected together, and what they say of its hypotheses."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final, Literal, final

from latentarm.core.types import FloatArray
from latentarm_research.studies.means_test import MeansTest
from latentarm_research.studies.statistics import LEVEL, holm
from latentarm_research.user_studies.analysis.means import Sides
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import StudyDesign, design_of
from latentarm_research.user_studies.hypothesis import Claim, Hypothesis
from latentarm_research.user_studies.record import Trial

Said = Literal["held", "not held", "could not be tested"]

NOT_MEASURED: Final = "nobody has a figure for it"
NO_SPREAD: Final = "all people differ alike"


@final
@dataclass(frozen=True)
class Tested:
    """What became of one claim."""

    hypothesis: str  # that it belongs to
    claim: Claim  # what is claimed
    n: int  # people who are compared: who have both sides, or in a study between people either
    mean: float | None  # of the subject's side; None without people
    sd: float | None  # of the people's means; None for fewer than two
    mean_against: float | None  # of the other side
    sd_against: float | None  # the same
    test: MeansTest | None  # of the difference; None where it could not be made
    p: float | None  # of the claim's own test, two-sided t or TOST, before correction; None where not tested
    p_holm: float | None = None  # after Holm's correction over the study
    why_not: str = ""  # why it could not be tested; empty where it was

    @property
    def says(self) -> Said:
        """Whether the claim held."""
        if self.p_holm is None or self.test is None:
            return "could not be tested"
        direction = self.claim.direction
        its_way = direction == "equal" or (self.test.difference < 0.0) == (direction == "less")
        return "held" if its_way and self.p_holm < LEVEL else "not held"

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        test = None if self.test is None else self.test.as_json()
        return {**asdict(self), "test": test, "says": self.says}


@final
@dataclass(frozen=True)
class Verdict:
    """What became of a hypothesis."""

    hypothesis: Hypothesis  # the hypothesis
    says: Said  # held where all claims held; not held where one did not; else it could not be tested
    why: str  # which claims did not hold or could not be tested, in words


def sides_of(definition: Definition, trials: Sequence[Trial]) -> list[Sides]:
    """Both sides of every claim of a study, in order."""
    design = design_of(definition)
    return [design.sides(trials, claim) for claim in definition.claims]


def claims_tested(definition: Definition, both: Sequence[Sides]) -> list[Tested]:
    """Test all claims of a study, and correct them together."""
    owners = [hypothesis.name for hypothesis in definition.hypotheses for _ in hypothesis.claims]
    design = design_of(definition)
    found = [_tested(design, *one) for one in zip(owners, definition.claims, both, strict=True)]
    corrected = holm([one.p for one in found])
    return [replace(one, p_holm=p) for one, p in zip(found, corrected, strict=True)]


def verdicts(definition: Definition, tested: Sequence[Tested]) -> list[Verdict]:
    """What the claims say of each hypothesis."""
    return [
        _verdict(definition, hypothesis, [one for one in tested if one.hypothesis == hypothesis.name])
        for hypothesis in definition.hypotheses
    ]


def worded(definition: Definition, claim: Claim) -> str:
    """A claim in words, such as ``time: LA+SA < R``."""
    sign = {"less": "<", "greater": ">", "equal": "="}[claim.direction]
    margin = f" ± {claim.margin:g}" if claim.margin is not None else ""
    tasks = {task.name: task.label for task in definition.tasks}
    where = f" ({', '.join(tasks[task] for task in claim.tasks)})" if claim.tasks else ""
    subject, against = (" and ".join(side) for side in (claim.subject, claim.against))
    return f"{definition.label(claim.measure)}{where}: {subject} {sign} {against}{margin}"


def _tested(design: StudyDesign, hypothesis: str, claim: Claim, both: Sides) -> Tested:
    n = len({*both.people, *both.people_against})
    too_few = design.too_few(both)
    test = None if too_few else design.test(both)
    p = None if test is None else test.p
    if test is not None and claim.margin is not None:
        p = test.p_of_equality(claim.margin)
    why_not = "" if p is not None else NOT_MEASURED if n == 0 else too_few or NO_SPREAD
    (mean, sd), (mean_against, sd_against) = (_spread(side) for side in (both.subject, both.against))
    return Tested(
        hypothesis=hypothesis,
        claim=claim,
        n=n,
        mean=mean,
        sd=sd,
        mean_against=mean_against,
        sd_against=sd_against,
        test=test,
        p=p,
        why_not=why_not,
    )


def _spread(means: FloatArray) -> tuple[float | None, float | None]:
    """Mean and SD of people's means (n,); None where there are too few for it."""
    return (
        float(means.mean()) if len(means) else None,
        float(means.std(ddof=1)) if len(means) > 1 else None,
    )


def _verdict(definition: Definition, hypothesis: Hypothesis, tested: Sequence[Tested]) -> Verdict:
    if not tested:
        return Verdict(hypothesis, "could not be tested", "no measure of the study is about it")
    failed = [worded(definition, one.claim) for one in tested if one.says == "not held"]
    untested = [
        f"{worded(definition, one.claim)} ({one.why_not})"
        for one in tested
        if one.says == "could not be tested"
    ]
    if failed:
        return Verdict(
            hypothesis, "not held", f"{len(failed)} of {len(tested)} claims do not hold: {'; '.join(failed)}"
        )
    if untested:
        return Verdict(
            hypothesis,
            "could not be tested",
            f"{len(untested)} of {len(tested)} claims could not be tested: {'; '.join(untested)}",
        )
    return Verdict(hypothesis, "held", f"all {len(tested)} claims hold")
