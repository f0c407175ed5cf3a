"""What a report says of a study's design: who met which conditions, and how these are compared."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from latentarm_research.studies.means_test import CONFIDENCE
from latentarm_research.user_studies.definition import Definition, Design

_CLAIMS: Final = (
    "Claims of equality are tested by two one-sided tests (TOST). p is also given after Holm's correction"
    " over all claims of the study."
)


@final
@dataclass(frozen=True)
class DesignWords:
    """A design in words."""

    met: str  # who met which conditions
    order: str  # how conditions were assigned, unless the definition has orders of its own
    tests: str  # how claims are tested
    effect_head: str  # heading of the column of effect sizes
    anova: str  # what the analysis of variance of a 2 x 2 design is called


WORDS: Final[Mapping[Design, DesignWords]] = {
    "within": DesignWords(
        met="Each person has all conditions (within subjects).",
        order="Each person meets the conditions in an order of a Williams design: every condition stands at"
        " every place, and follows every other, equally often. Conditions and rows of the design are assigned"
        " at random, from the seed.",
        tests="Paired t-tests on people's means, two-sided; intervals are of 95 %; dz is the mean difference"
        " over its SD, with its interval from the noncentral t distribution, and g is dz without its bias in"
        f" small samples. {_CLAIMS} The mixed model has condition, order, trial and task as fixed and the"
        " person as random; its p is that of a randomisation test, which swaps the two conditions of each"
        " person, because degrees of freedom of mixed models do not hold for so few people.",
        effect_head=f"dz [{CONFIDENCE:.0%}]; g",
        anova="Repeated-measures analysis of variance",
    ),
    "between": DesignWords(
        met="Each person has one condition (between subjects).",
        order="People are assigned to conditions at random, from the seed, in blocks that each have every"
        " condition once.",
        tests="Welch's t-tests on people's means, two-sided; intervals are of 95 %; g is the difference over"
        " the pooled SD, without its bias in small samples, with its interval from the noncentral t"
        f" distribution. {_CLAIMS} The mixed model has condition, trial and task as fixed and the person as"
        " random; it is left out where each person has a single trial. The p of the randomisation test"
        " permutes people between the two conditions, on their means.",
        effect_head=f"g [{CONFIDENCE:.0%}]",
        anova="Analysis of variance between people",
    ),
}


def order_words(definition: Definition) -> str:
    """How people came to their conditions, in a sentence or two."""
    if definition.orders:
        every = "; ".join(" then ".join(order) for order in definition.orders)
        return f"People take turns with these orders: {every}."
    return WORDS[definition.design].order


def claim_head(definition: Definition) -> tuple[str, ...]:
    """Headings of the table of claims."""
    return (
        "",
        "claim",
        "n",
        "subject, mean ± SD",
        "other, mean ± SD",
        f"difference [{CONFIDENCE:.0%}]",
        "test",
        "p / p, Holm",
        WORDS[definition.design].effect_head,
        "mixed model ± SE",
        "p, randomisation",
        "says",
    )
