"""Section 9.3: latent actions and shared autonomy, alone and together, at an entree and a dessert."""

from typing import Final

from latentarm_research.studies.claims import Claim, Hypothesis
from latentarm_research.user_studies.definition import Condition, Definition, Factor, StudyTask
from latentarm_research.user_studies.definitions.shared import AGAIN, NO_INPUT
from latentarm_research.user_studies.hypothesis import Printed, above, below
from latentarm_research.user_studies.questionnaire import PREFER, scale

R, R_SA, LA, LA_SA = "R", "R+SA", "LA", "LA+SA"
HELPED: Final = (R_SA, LA_SA)
UNHELPED: Final = (R, LA)
OTHERS: Final = (R, R_SA, LA)

TRIAL_S: Final = 240.0

ENTREE: Final = StudyTask(
    "entree",
    "Entree",
    "entree",
    trials=1,
    choices=(0,),
    plates=("dish", "own plate"),
    demonstrations_min=10.0,
    trial_s=TRIAL_S,
)
DESSERT: Final = StudyTask(
    "dessert",
    "Dessert",
    "dessert",
    trials=1,
    choices=(0,),
    plates=("plate", "icing", "rice bowl", "own plate"),
    demonstrations_min=10.0,
    trial_s=TRIAL_S,
)

LATENT_HELPED: Final = Condition(
    LA_SA,
    "latent actions in the context of joints and belief, with shared autonomy",
    "latent",
    "cvae",
    ("joints", "belief"),
    assists="blending",
)

SCALES: Final = (
    scale(
        "easy",
        "Easy",
        ("It was easy to do both dishes.", "I managed without much effort."),
        ("The dishes were hard to do.", "I struggled with the control."),
    ),
    scale(
        "helpful",
        "Helpful",
        ("The robot helped me.", "The robot did what I was about to do."),
        ("The robot got in my way.", "I had to work against the robot."),
    ),
    scale(
        "precise",
        "Precise",
        ("I could cut, stab and scoop exactly where I wanted.", "Small movements came out as I meant them."),
        ("My movements were rough.", "I could not hold the fork where I wanted it."),
    ),
    scale(
        "intuitive",
        "Intuitive",
        ("I knew at once what the stick would do.", "The control felt obvious."),
        ("I had to think about what the stick would do.", "The control confused me."),
    ),
    PREFER,
)

DEFINITION: Final = Definition(
    name="eating",
    title="Latent actions with shared autonomy",
    section="9.3",
    about="What do latent actions and shared autonomy contribute, alone and together, to two dishes?",
    people=12,
    papers_people="ten people",
    conditions=(
        Condition(R, "the stick retargeted to the 6-DoF twist of the end-effector", "retargeting"),
        Condition(R_SA, "the same, with shared autonomy", "retargeting", assists="blending"),
        Condition(LA, "latent actions in the context of the joints", "latent", "cvae", ("joints",)),
        LATENT_HELPED,
    ),
    tasks=(ENTREE, DESSERT),
    orders=(),
    practice_min=5.0,
    input="one stick with two axes",
    measures=(
        "success_rate",
        "attempts",
        "steps_done",
        "time_s",
        "idle_s",
        "goal_error_m_s",
        "goal_error_m",
        "preference_alignment",
        "input_magnitude",
        "path_length",
    ),
    questionnaire=SCALES,
    hypotheses=(
        Hypothesis(
            "H1",
            "Users controlling the robot with shared autonomy will more accurately maintain their goals.",
            (
                Claim("goal_error_m_s", HELPED, UNHELPED, "less"),
                *below("goal_error_m_s", LA_SA, LA),
                *below("goal_error_m_s", R_SA, R),
            ),
        ),
        Hypothesis(
            "H2",
            "Latent actions will help users more precisely perform manipulation tasks.",
            above("preference_alignment", LA_SA, R_SA, tasks=("dessert",)),
        ),
        Hypothesis(
            "H3",
            "Participants will complete the task most efficiently with combined LA+SA.",
            (*below("time_s", LA_SA, *OTHERS), *below("idle_s", LA_SA, *OTHERS)),
        ),
    ),
    exclusions=(NO_INPUT,),
    factors=(
        Factor("Control Interface", ("Retargeting", (R, R_SA)), ("Latent actions", (LA, LA_SA))),
        Factor("Robot Assistance", ("without", UNHELPED), ("with shared autonomy", HELPED)),
    ),
    printed=(
        Printed("between F", "goal_error_m_s", HELPED, UNHELPED, "F(1, 18) = 29.9, p < .001", True, True),
        Printed("paired p", "goal_error_m_s", (LA_SA,), (LA,), "p < .001", True, True),
        Printed("paired p", "goal_error_m_s", (R_SA,), (R,), "p < .05", True, True),
        *(
            Printed("paired p", measure, (LA_SA,), (other,), "p < .05", True, True)
            for measure in ("time_s", "idle_s")
            for other in OTHERS
        ),
    ),
    departures=(
        AGAIN,
        "The paper's shared autonomy is that of Javdani et al. (2018), whose goals are over the plates: it"
        " pulls the fork back up while a person stabs. Here both SA conditions have the help of Algorithm 1:"
        " equations 2 and 3, with goals that move on with the steps of the dish, and an alpha of 0.15 that"
        " fades as the stick is let go.",
        "Each dish has a model of its own, from half of the 20 minutes of demonstrations.",
        "The paper's people practised before every trial; here people practise before each condition.",
        "The paper's items are not published: all items are ours.",
    ),
)
