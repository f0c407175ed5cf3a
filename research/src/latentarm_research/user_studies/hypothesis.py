"""The statistics that the paper prints."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, final

PrintedTest = Literal["trials t", "paired t", "between F", "paired p", "share", "stars", "seconds"]
"""How a figure of the paper came about: t over trials as independent, t over people in pairs, F with the
factor taken as between people, p of a paired comparison without its statistic, a share of trials, stars in a
figure without any number, a bound on a time."""


@final
@dataclass(frozen=True)
class Printed:
    """One statistic of the paper."""

    test: PrintedTest
    """Origin of the statistic."""
    measure: str
    """A measure of the study, or a scale of its questionnaire."""
    subject: tuple[str, ...]
    """Conditions compared, as in `latentarm_research.studies.claims.Claim`."""
    against: tuple[str, ...]
    """Other conditions; empty for figures of one condition."""
    text: str
    """The statistic as the paper prints it."""
    less: bool | None
    """True if the subject has less than the others, in the paper; None if that is not said."""
    significant: bool | None
    """True if the paper calls it significant; None without a test."""
    tasks: tuple[str, ...] = ()
    """Tasks whose trials it is about; all where empty."""


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
