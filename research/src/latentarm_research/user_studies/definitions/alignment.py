"""Section 9.4: learning what people mean by their stick, with priors and without."""

from typing import Final

from latentarm_research.studies.claims import Hypothesis
from latentarm_research.user_studies.definition import Aligns, Condition, Definition, StudyTask
from latentarm_research.user_studies.definitions.shared import AGAIN, NO_INPUT
from latentarm_research.user_studies.hypothesis import Printed, below
from latentarm_research.user_studies.questionnaire import Scale, scale

ALL_PRIORS: Final = "All Priors"
BASELINES: Final = ("No Align", "No Priors")
MEASURED: Final = ("time_s", "path_length", "turned_round")
QUERIES: Final = {"avoid": 7, "pour": 10, "reach_and_pour": 30}
"""Motions that people are asked about before each task."""

LABELS: Final = {"avoid": "Avoid", "pour": "Pour", "reach_and_pour": "Reach & Pour"}


TRIAL_S: Final = 180.0


def _condition(name: str, about: str, aligns: Aligns) -> Condition:
    return Condition(name, about, "latent", "cvae", ("joints",), aligns=aligns)


def _scale(name: str, yes: str, also: str, no: str, nor: str) -> Scale:
    return scale(name, name.replace("_", " ").capitalize(), (yes, also), (no, nor))


DEFINITION: Final = Definition(
    name="alignment",
    title="Learning the alignment between inputs and latent actions",
    section="9.4",
    about="Is an arm easier to control once it has learned, from few answers and priors, what people mean?",
    people=12,
    papers_people="ten people",
    conditions=(
        _condition("No Align", "the input is the latent action", "none"),
        _condition("No Priors", "an alignment learned from the person's answers alone", "no_priors"),
        _condition(
            ALL_PRIORS, "the same answers with the priors: proportional, reversible, consistent", "all_priors"
        ),
    ),
    tasks=tuple(
        StudyTask(
            name,
            LABELS[name],
            name,
            trials=1,
            choices=(0,),
            queries=queries,
            demonstrations_min=7.0,
            trial_s=TRIAL_S,
        )
        for name, queries in QUERIES.items()
    ),
    orders=(),
    practice_min=0.0,
    input="one stick with two axes",
    measures=("success_rate", "attempts", "steps_done", *MEASURED, "input_magnitude", "idle_s"),
    questionnaire=(
        _scale(
            "aligned",
            "The arm went where I pushed.",
            "The stick meant what I expected.",
            "I pushed one way and the arm went another.",
            "I had to learn the stick anew.",
        ),
        _scale(
            "natural_control",
            "Steering felt natural.",
            "My hand knew what to do.",
            "Steering felt odd.",
            "I had to translate what I wanted.",
        ),
        _scale(
            "accurate",
            "I came exactly where I wanted.",
            "Corrections were easy.",
            "I overshot often.",
            "I could not hit what I aimed at.",
        ),
        _scale(
            "effortless",
            "It took little effort.",
            "I could have gone on for long.",
            "It was exhausting.",
            "I had to concentrate all the time.",
        ),
        _scale(
            "efficient",
            "I got things done quickly.",
            "No movement was wasted.",
            "I lost a lot of time.",
            "I often had to go back.",
        ),
        _scale(
            "use_again",
            "I would use this control again.",
            "I liked this control.",
            "I would rather not use this control.",
            "I disliked this control.",
        ),
    ),
    hypotheses=(
        Hypothesis(
            "H1",
            "An alignment model learned from user-specific feedback and generalized through intuitive priors"
            " will make it easier for humans to control the robot and perform assistive manipulation tasks.",
            tuple(claim for name in MEASURED for claim in below(name, ALL_PRIORS, *BASELINES)),
        ),
    ),
    exclusions=(NO_INPUT,),
    factors=(),
    printed=tuple(
        Printed(
            "stars", measure, (ALL_PRIORS,), (other,), "stars in a figure, p < .05 where marked", True, None
        )
        for measure in MEASURED
        for other in BASELINES
    ),
    departures=(
        AGAIN,
        "The paper does not say from how much its models learned: here 7 minutes of demonstrations of each"
        " task.",
        "The paper's text says that All Priors outperforms both baselines across tasks and measures, and"
        " leaves which comparisons are significant to the stars of a figure.",
        "The paper's items are not published: all items are ours.",
    ),
)
