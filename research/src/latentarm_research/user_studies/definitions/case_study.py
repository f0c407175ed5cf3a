"""Section 10: the case study with two disabled people, who steered from their homes."""

from dataclasses import replace
from typing import Final

from latentarm_research.studies.claims import Hypothesis
from latentarm_research.user_studies.definition import Condition, Definition
from latentarm_research.user_studies.definitions.eating import DEFINITION as EATING
from latentarm_research.user_studies.definitions.eating import DESSERT, ENTREE, LA_SA, LATENT_HELPED
from latentarm_research.user_studies.definitions.shared import AGAIN, NO_INPUT
from latentarm_research.user_studies.hypothesis import Printed, below

DIRECT: Final = "End-Effector"

TRIAL_S: Final = 360.0
"""More than five minutes, which the paper's people took over the Dessert with End-Effector, s."""

DEFINITION: Final = Definition(
    name="case_study",
    title="Case study: two dishes from afar",
    section="10",
    about="Do people who steer from afar, on a page, do two dishes better with latent actions and shared"
    " autonomy?",
    people=12,
    papers_people="two men with disabilities, 28 and 42 years old, with three and two years of experience"
    " with such arms",
    conditions=(
        Condition(DIRECT, "two sticks, one for linear and one for angular motion", "two_sticks"),
        LATENT_HELPED,
    ),
    tasks=(replace(DESSERT, trial_s=TRIAL_S), replace(ENTREE, trial_s=TRIAL_S)),
    orders=((DIRECT, LA_SA), (LA_SA, DIRECT)),
    practice_min=5.0,
    input="a virtual stick on a page, drawn over a grid, next to two live views of the arm",
    measures=tuple(name for name in EATING.measures if name != "preference_alignment"),
    questionnaire=(),
    hypotheses=(
        Hypothesis(
            "H1",
            "Disabled users will complete the eating tasks more quickly and accurately with our combination"
            " of latent actions and shared autonomy.",
            (*below("time_s", LA_SA, DIRECT), *below("goal_error_m_s", LA_SA, DIRECT)),
        ),
        Hypothesis(
            "H2",
            "Disabled users will subjectively prefer LA+SA to their current control approach (End-Effector).",
            (),
        ),
    ),
    exclusions=(NO_INPUT,),
    factors=(),
    printed=(
        Printed(
            "seconds", "time_s", (DIRECT,), (), "Dessert over 5 minutes for both", None, None, ("dessert",)
        ),
        Printed(
            "seconds", "time_s", (LA_SA,), (), "Dessert under 2 minutes for both", None, None, ("dessert",)
        ),
    ),
    departures=(
        AGAIN,
        "The help of LA+SA is that of Algorithm 1, as in section 9.3 here.",
        "The paper's two people are described one by one and nothing is tested. Twelve simulated people take"
        " turns with the two orders, and are tested; they stand for nobody with a disability.",
        "The paper's Dessert ends in sprinkles; here it ends in rice, as in section 9.3.",
        "The paper's people answered an open questionnaire: H2 has no figure and cannot be tested.",
    ),
)
