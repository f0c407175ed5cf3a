"""Section 9.2: latent actions against direct teleoperation of the end-effector, at an apple pie."""

from typing import Final

from latentarm_research.studies.claims import Claim, Hypothesis
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.definitions.shared import AGAIN, NO_INPUT
from latentarm_research.user_studies.hypothesis import Printed, above, below
from latentarm_research.user_studies.questionnaire import PREFER, scale

DIRECT: Final = "End-Effector"
LATENT: Final = "cVAE"

PART_S: Final = 240.0

SCALES: Final = (
    scale(
        "ease",
        "Ease",
        ("Cooking with this control took little effort.", "I could do what I wanted without thinking hard."),
        ("I was tired by the end.", "I had to concentrate all the time."),
    ),
    scale(
        "consistent",
        "Consistent",
        ("The same push always did the same.", "I could tell beforehand what the arm would do."),
        ("The arm surprised me.", "What a push did changed from moment to moment."),
    ),
    scale(
        "easier",
        "Easier",
        ("This control made the recipe easy.", "I would choose this control to finish quickly."),
        ("This control made the recipe hard.", "The other control would have saved me work."),
    ),
    scale(
        "natural",
        "Natural",
        ("The arm moved as a person's arm would.", "The motion looked smooth."),
        ("The arm moved like a machine.", "The motion looked jerky."),
    ),
    scale(
        "precise",
        "Precise",
        ("I could place the tool exactly.", "Small corrections worked at once."),
        ("I kept missing the place that I wanted.", "Pouring exactly was out of my control."),
    ),
    PREFER,
)

DEFINITION: Final = Definition(
    name="apple_pie",
    title="Latent actions compared with end-effector teleoperation",
    section="9.2",
    about="Do people cook a pie more quickly and with less effort by latent actions than with two sticks?",
    people=12,
    papers_people="eleven people, four of whom knew the robot",
    conditions=(
        Condition(
            DIRECT,
            "two sticks move the end-effector; a button toggles linear and angular motion",
            "two_sticks",
        ),
        Condition(LATENT, "one stick, one latent action per axis", "latent", "cvae", ("joints", "gripper")),
    ),
    tasks=(
        StudyTask(
            "parts",
            "Parts",
            "apple_pie",
            trials=3,
            choices=(0, 1, 2),
            demonstrations_min=6.9,
            trial_s=PART_S,
        ),
        StudyTask(
            "whole",
            "Whole",
            "apple_pie",
            trials=1,
            choices=(0, 1, 2),
            all_choices=True,
            trained_with="parts",
            trial_s=PART_S,
        ),
    ),
    orders=(),
    practice_min=0.0,
    input="two sticks with two axes each, or one of them",
    measures=(
        "success_rate",
        "attempts",
        "steps_done",
        "time_s",
        "input_magnitude",
        "idle_s",
        "path_length",
        "mode_switches",
    ),
    questionnaire=SCALES,
    hypotheses=(
        Hypothesis(
            "H1",
            "Users controlling the robot arm with low-DoF latent actions will complete the cooking task more"
            " quickly and with less overall effort.",
            (
                *below("time_s", LATENT, DIRECT, tasks=("whole",)),
                *below("input_magnitude", LATENT, DIRECT, tasks=("whole",)),
            ),
        ),
        Hypothesis(
            "H2",
            "Participants will perceive the robot as easier to work with in the cVAE condition, and will"
            " prefer the cVAE over End-Effector teleoperation.",
            tuple(
                claim
                for name in ("ease", "easier", "natural", "prefer")
                for claim in above(name, LATENT, DIRECT)
            ),
        ),
        Hypothesis(
            "N1",
            "The paper's finding that there is no clear preference, as a claim of equality within half a"
            " point.",
            (Claim("prefer", (LATENT,), (DIRECT,), "equal", margin=0.5),),
        ),
    ),
    exclusions=(NO_INPUT,),
    factors=(),
    printed=(
        Printed("paired t", "time_s", (LATENT,), (DIRECT,), "t(10) = -6.9, p < .001", True, True, ("whole",)),
        Printed(
            "paired t",
            "input_magnitude",
            (LATENT,),
            (DIRECT,),
            "t(10) = -5.1, p < .001",
            True,
            True,
            ("whole",),
        ),
        Printed("paired t", "ease", (LATENT,), (DIRECT,), "t(10) = 2.7, p < .05", False, True),
        Printed("paired t", "easier", (LATENT,), (DIRECT,), "t(10) = 2.5, p < .05", False, True),
        Printed("paired t", "natural", (LATENT,), (DIRECT,), "t(10) = 3.8, p < .01", False, True),
        Printed("paired t", "prefer", (LATENT,), (DIRECT,), "not significant", None, False),
    ),
    departures=(
        AGAIN,
        "The arm goes back to its home between the three parts, in the whole recipe too: the whole is the"
        " three parts in one arrangement, their figures summed. The paper's whole has no breaks.",
        "Things stand at new places in every trial; the paper moved shelf, bowl and bin now and then.",
        "The two sticks move three axes at once, linear or angular; the paper's have four axes for three.",
        "The paper's people saw a video of the task and a sheet that labels the inputs; here is neither.",
        "The paper's items are not published: all items are ours.",
    ),
)
