"""Section 9.1: latent actions against the four levels of assistance of the HARMONIC dataset."""

from typing import Final

from latentarm_research.studies.claims import Hypothesis
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.definitions.shared import NO_INPUT
from latentarm_research.user_studies.hypothesis import Printed, above, below

ASSISTED: Final = ("No Assist", "Low Assist", "High Assist", "Full Assist")
LATENT: Final = "cVAE"


def _assisted(name: str, weight: float, share: str) -> Condition:
    about = f"mode-switched control of the end-effector; {share}"
    return Condition(name, about, "modes", assists="interpolation", weight=weight)


DEFINITION: Final = Definition(
    name="harmonic",
    title="Latent actions compared with the HARMONIC baselines",
    section="9.1",
    about="Do people bring the fork over a marshmallow better by latent actions than with assisted mode"
    " switching?",
    people=12,
    papers_people="ten people drove with cVAE; the four other conditions are those of 24 other people in"
    " HARMONIC",
    conditions=(
        _assisted("No Assist", 0.0, "no assistance"),
        _assisted("Low Assist", 1 / 3, "assistance has weight 1/3"),
        _assisted("High Assist", 2 / 3, "assistance has weight 2/3, twice that of the person"),
        _assisted("Full Assist", 1.0, "assistance has weight 1"),
        Condition(
            LATENT, "one latent action per axis of the stick, no assistance", "latent", "cvae", ("joints",)
        ),
        Condition("R", "the stick retargeted to the 6-DoF twist of the end-effector", "retargeting"),
    ),
    tasks=(
        StudyTask(
            "marshmallows",
            "Marshmallows",
            "over_marshmallow",
            trials=5,
            choices=(0, 1, 2),
            demonstrations_min=7.0,
        ),
    ),
    orders=(),
    practice_min=5.0,
    input="one stick with two axes; a button switches modes",
    measures=("success_rate", "time_s", "input_magnitude", "path_length", "mode_switches", "idle_s"),
    questionnaire=(),
    hypotheses=(
        Hypothesis(
            "H1",
            "Compared to the baselines, latent actions will improve task success while reducing the"
            " completion time, joystick inputs, and trajectory length.",
            (
                *above("success_rate", LATENT, *ASSISTED),
                *(
                    claim
                    for name in ("time_s", "input_magnitude", "path_length")
                    for claim in below(name, LATENT, *ASSISTED)
                ),
            ),
        ),
    ),
    exclusions=(NO_INPUT,),
    factors=(),
    printed=(
        Printed("share", "success_rate", (LATENT,), (), "44 of 50 trials", None, None),
        Printed("trials t", "time_s", (LATENT,), ("High Assist",), "t(158) = 2.95, p < .05", True, True),
        Printed(
            "trials t", "input_magnitude", (LATENT,), ("High Assist",), "t(158) = 2.49, p < .05", True, True
        ),
        Printed(
            "trials t", "path_length", (LATENT,), ("High Assist",), "t(158) = 9.39, p < .001", True, True
        ),
    ),
    departures=(
        "The paper compares two groups of people: its own ten with cVAE, and HARMONIC's 24 with the other"
        " four conditions. Here the same people have all conditions.",
        "Retargeting (R, of section 9.3) is a condition here, so that the same people drive with every level"
        " of help, with retargeting and with latent actions. No hypothesis is about it.",
        "The paper says that High Assist gives assistance twice the weight of the person. The weights 0, 1/3"
        " and 1 of the other levels are read from that.",
        "The paper's model learned from HARMONIC, which is not available offline. Here it learns from"
        " demonstrations of the same task.",
        "The paper's trials end when the person says that the fork is above the marshmallow. Here they end"
        " when it is, and fail after the task's limit; the fork is over the right marshmallow or the trial"
        " goes on.",
    ),
)
