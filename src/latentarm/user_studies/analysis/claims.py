"""The tests of a study's claims, corrected together, and what they say of its hypotheses."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.studies.statistics import LEVEL, holm
from latentarm.user_studies.analysis.equivalence import equivalence
from latentarm.user_studies.analysis.means import Sides, sides
from latentarm.user_studies.analysis.paired import Paired, paired_test
from latentarm.user_studies.definition import Definition
from latentarm.user_studies.hypothesis import Claim, Hypothesis
from latentarm.user_studies.record import Trial

Said = Literal["held", "not held", "could not be tested"]

NOT_MEASURED: Final = "nobody has a figure for it"
TOO_FEW: Final = "fewer than two people have both sides"
NO_SPREAD: Final = "all people differ alike"


@final
@dataclass(frozen=True)
class Tested:
    """What became of one claim.

    Attributes:
        hypothesis: that it belongs to.
        claim: what is claimed.
        n: people who have both sides.
        mean: of the subject's side; None without people.
        sd: of the people's means; None for fewer than two.
        mean_against: of the other side.
        sd_against: the same.
        paired: the test of the differences; None where it could not be made.
        p: of the claim's own test, two-sided paired t or TOST, before correction; None where not tested.
        p_holm: after Holm's correction over the study.
        why_not: why it could not be tested; empty where it was.
    """

    hypothesis: str
    claim: Claim
    n: int
    mean: float | None
    sd: float | None
    mean_against: float | None
    sd_against: float | None
    paired: Paired | None
    p: float | None
    p_holm: float | None = None
    why_not: str = ""

    @property
    def says(self) -> Said:
        """Whether the claim held."""
        if self.p_holm is None or self.paired is None:
            return "could not be tested"
        direction = self.claim.direction
        its_way = direction == "equal" or (self.paired.difference < 0.0) == (direction == "less")
        return "held" if its_way and self.p_holm < LEVEL else "not held"

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        entries = asdict(self)
        if self.paired is not None and np.isnan(self.paired.g):
            entries["paired"]["g"] = None
        return {**entries, "says": self.says}


@final
@dataclass(frozen=True)
class Verdict:
    """What became of a hypothesis.

    Attributes:
        hypothesis: the hypothesis.
        says: held where all claims held; not held where one did not; else it could not be tested.
        why: which claims did not hold or could not be tested, in words.
    """

    hypothesis: Hypothesis
    says: Said
    why: str


def sides_of(definition: Definition, trials: Sequence[Trial]) -> list[Sides]:
    """Both sides of every claim of a study, in order.

    Args:
        definition: of the study.
        trials: that count.
    """
    return [sides(trials, claim) for claim in definition.claims]


def claims_tested(definition: Definition, both: Sequence[Sides]) -> list[Tested]:
    """Test all claims of a study, and correct them together.

    Args:
        definition: of the study.
        both: sides of every claim, as `sides_of` gives them.
    """
    owners = [hypothesis.name for hypothesis in definition.hypotheses for _ in hypothesis.claims]
    found = [_tested(*one) for one in zip(owners, definition.claims, both, strict=True)]
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


def _tested(hypothesis: str, claim: Claim, both: Sides) -> Tested:
    n = len(both.people)
    paired = paired_test(both.differences) if n > 1 else None
    p = None if paired is None else paired.p
    if paired is not None and claim.margin is not None:
        p = equivalence(both.differences, claim.margin)
    why_not = "" if p is not None else NOT_MEASURED if n == 0 else TOO_FEW if n < 2 else NO_SPREAD
    return Tested(
        hypothesis=hypothesis,
        claim=claim,
        n=n,
        mean=float(both.subject.mean()) if n else None,
        sd=float(both.subject.std(ddof=1)) if n > 1 else None,
        mean_against=float(both.against.mean()) if n else None,
        sd_against=float(both.against.std(ddof=1)) if n > 1 else None,
        paired=paired,
        p=p,
        why_not=why_not,
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
