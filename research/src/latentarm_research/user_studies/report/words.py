"""What the report says in words: people, design, methods, and figures as people read them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from latentarm.evaluation.table import ABSENT
from latentarm_research.people.population import MIRRORED, TRAITS
from latentarm_research.people.traits import Traits
from latentarm_research.studies.claim_tables import claim_columns, columns_table
from latentarm_research.studies.statistics import CONFIDENCE, MeansTest, format_p
from latentarm_research.studies.tables import listed
from latentarm_research.user_studies.analysis.analysis import TestedClaim
from latentarm_research.user_studies.definition import Condition, Definition, Design, StudyTask
from latentarm_research.user_studies.record import PeopleAre

PEOPLE_HEAD: Final = ("trait", "mean (range)", "where it comes from")


def people_lines(people: Sequence[Traits]) -> list[tuple[str, str, str]]:
    """Every trait over some people, with its source."""
    lines = [
        (
            f"{one.meaning} ({one.unit})" if one.unit else one.meaning,
            _spans([float(getattr(person, one.name)) for person in people]),
            one.source,
        )
        for one in TRAITS
    ]
    mirrored = sum(person.mirrored for person in people)
    upside_down = (
        "second axis upside down for them",
        f"{mirrored} of {len(people)}",
        f"chosen: a share of {MIRRORED:g}",
    )
    return [*lines, upside_down]


def _spans(values: Sequence[float]) -> str:
    figures = sum(values) / len(values), min(values), max(values)
    mean, low, high = (f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}" for value in figures)
    return f"{mean} ({low} to {high})"


NOTICE: Final[Mapping[PeopleAre, str]] = {
    "simulated": "Everything here is simulated: the arm, the things, the demonstrator and the people who"
    " drive. No person took part.",
    "real": "The trials are those of real people.",
}
"""Stands over everything."""

UNASKED: Final[Mapping[PeopleAre, str]] = {
    "simulated": "Simulated people have no opinions: nobody was asked, and every claim about ratings could"
    " not be tested.",
    "real": "No answers were given to this analysis: every claim about ratings could not be tested.",
}
"""Of a questionnaire without answers."""

QUOTED: Final = "Figures of the paper are quoted as the paper's and come from the paper's own people."


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


DESIGN_WORDS: Final[Mapping[Design, DesignWords]] = {
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
    return DESIGN_WORDS[definition.design].order


CONTROLS: Final = {
    "modes": "two axes of the end-effector at a time; a button switches which",
    "two_sticks": "two sticks for the end-effector; a button toggles linear and angular motion",
    "retargeting": "the stick retargeted to the twist of the end-effector; a button switches which two axes",
    "latent": "latent actions",
}
ASSISTS: Final = {
    "none": "no assistance",
    "interpolation": "assistance by interpolation",
    "blending": "shared autonomy of Algorithm 1",
}
ALIGNS: Final = {
    "none": "z = u",
    "no_priors": "alignment learned from answers alone",
    "all_priors": "alignment learned from answers and priors",
}


def condition_parts(condition: Condition) -> tuple[str, str, str, str]:
    """Controls, model, assistance and alignment of a condition, in words."""
    model = f"{condition.model}, sees {listed(condition.context)}" if condition.model else ABSENT
    helps = ASSISTS[condition.assists]
    if condition.assists == "interpolation":
        helps = f"{helps}, weight {condition.weight:.2g}"
    return CONTROLS[condition.controls], model, helps, ALIGNS[condition.aligns] if condition.model else ABSENT


def task_words(task: StudyTask) -> str:
    """How a task goes, in a sentence or two."""
    trials = f"{task.trials} trial{'s' if task.trials > 1 else ''} in each condition"
    parts = [f"{task.label}: {trials}"]
    if task.all_choices:
        parts.append("each of all parts one after the other, their figures summed")
    if task.trial_s:
        parts.append(
            f"after a failure everything is set up anew and people begin again, for {task.trial_s:g} s"
            f" {'per part' if task.all_choices else 'in all'}"
        )
    if task.queries:
        parts.append(f"{task.queries} alignment queries before it")
    if task.demonstrations_min:
        parts.append(f"a model from at most {task.demonstrations_min:g} minutes of demonstrations")
    if task.trained_with:
        parts.append("with the model of the other task")
    return "; ".join(parts) + "."


def exclusion_words(definition: Definition) -> list[str]:
    """Each rule in a sentence."""
    side = {"less": "below", "more": "above"}
    return [
        f"A trial with {definition.label(rule.measure)} {side[rule.side]} {rule.limit:g} does not count:"
        f" {rule.why}."
        for rule in definition.exclusions
    ]


def claim_table(definition: Definition, claims: Sequence[TestedClaim]) -> str:
    """Every claim, tested on people's means and in a model of all trials, in Markdown."""
    further: dict[str, list[str]] = {
        DESIGN_WORDS[definition.design].effect_head: [],
        "mixed model ± SE": [],
        "p, randomisation": [],
    }
    for one in claims:
        test, mixed = one.tested.test, one.mixed
        cells = (
            _effect_words(test) if test is not None else ABSENT,
            ABSENT if test is None or mixed is None else f"{mixed.estimate:.3g} ± {mixed.se:.2g}",
            ABSENT if test is None else format_p(one.p),
        )
        for column, cell in zip(further.values(), cells, strict=True):
            column.append(cell)
    tested = [one.tested for one in claims]
    return columns_table(claim_columns(tested, definition.label, definition.task_label, further))


def _effect_words(test: MeansTest) -> str:
    low, high = test.effect_interval
    g, interval = ABSENT if test.g is None else f"{test.g:.2f}", f"[{low:.2f}, {high:.2f}]"
    return f"{g} {interval}" if test.n_against else f"{test.d:.2f} {interval}; g {g}"


def yes_no(value: bool | None) -> str:
    """Yes, no, or a dash."""
    return ABSENT if value is None else "yes" if value else "no"
