"""The tests of a study's claims, corrected together, and what they say of its hypotheses."""

from collections.abc import Sequence
from typing import Final

from latentarm_research.studies.claims import Claim, Tested, Verdict, corrected, verdict_on
from latentarm_research.studies.statistics import Statistic
from latentarm_research.user_studies.analysis.means import Sides
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import StudyDesign, design_of
from latentarm_research.user_studies.record import Trial

NOT_MEASURED: Final = "nobody has a figure for it"
NO_SPREAD: Final = "all people differ alike"


def sides_of(definition: Definition, trials: Sequence[Trial]) -> list[Sides]:
    """Both sides of every claim of a study, in order."""
    design = design_of(definition)
    return [design.sides(trials, claim) for claim in definition.claims]


def claims_tested(definition: Definition, both: Sequence[Sides]) -> list[Tested]:
    """Test all claims of a study, and correct them together.

    ``less`` and ``greater`` are tested two-sided by t on people's means, ``equal`` by two one-sided tests.
    """
    owners = [hypothesis.name for hypothesis in definition.hypotheses for _ in hypothesis.claims]
    design = design_of(definition)
    return corrected(
        [
            Tested(hypothesis=owner, claim=claim).of(
                sides.subject, sides.against, _test(design, claim, sides)
            )
            for owner, claim, sides in zip(owners, definition.claims, both, strict=True)
        ]
    )


def verdicts(definition: Definition, tested: Sequence[Tested]) -> list[Verdict]:
    """What the claims say of each hypothesis."""
    return [
        verdict_on(
            hypothesis,
            [one for one in tested if one.hypothesis == hypothesis.name],
            definition.label,
            definition.task_label,
        )
        for hypothesis in definition.hypotheses
    ]


def worded(definition: Definition, claim: Claim) -> str:
    """A claim in words, such as ``time: LA+SA < R``."""
    return claim.worded(definition.label, definition.task_label)


def _test(design: StudyDesign, claim: Claim, both: Sides) -> Statistic:
    too_few = design.too_few(both)
    test = None if too_few else design.test(both)
    if test is None:
        nobody = not both.people and not both.people_against
        return Statistic("", why_not=NOT_MEASURED if nobody else too_few or NO_SPREAD)
    if claim.margin is not None:
        return Statistic("TOST", test, test.p_of_equality(claim.margin))
    return Statistic("t", test, test.p)
