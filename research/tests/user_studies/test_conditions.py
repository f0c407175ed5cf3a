import subprocess
import sys

import pytest

from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.goal_blending import GoalBlending
from latentarm_research.assistance.published_help import Interpolation
from latentarm_research.baselines.retargeting import RetargetingController
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.conditions import assistance_of, belief_of, controller_of
from latentarm_research.user_studies.scenes import scene_of

ROBOT = scene_of("over_marshmallow").robot
CONDITIONS = {
    (name, condition.name): condition for name in NAMES for condition in load_definition(name).conditions
}
CONTROLLERS = {
    "modes": (EndEffectorController, ("x-y", "z-yaw", "roll-pitch")),
    "two_sticks": (EndEffectorController, ("linear", "angular")),
    "retargeting": (RetargetingController, ("x-y", "z-yaw", "roll-pitch")),
}


@pytest.mark.parametrize("place", [place for place, one in CONDITIONS.items() if not one.model], ids=" ".join)
def test_a_condition_without_a_model_drives_with_what_it_says(place: tuple[str, str]) -> None:
    condition = CONDITIONS[place]
    kind, modes = CONTROLLERS[condition.controls]
    controller = controller_of(condition, ROBOT, None)
    assert isinstance(controller, kind)
    assert controller.modes == modes


def test_help_is_that_of_the_condition() -> None:
    goals = ROBOT.home[None]
    for (study, name), condition in CONDITIONS.items():
        rule = assistance_of(condition, ROBOT)
        helped = name in {"Low Assist", "High Assist", "Full Assist", "R+SA", "LA+SA"}
        assert (rule is not None) == helped
        if rule is not None:
            assert isinstance(rule(goals), Interpolation if study == "harmonic" else GoalBlending)
        assert (belief_of(condition, ROBOT) is BoltzmannBelief) == (condition.assists != "interpolation")


def test_latent_actions_without_a_model_are_a_mistake() -> None:
    with pytest.raises(ValueError, match="has no model"):
        controller_of(CONDITIONS["harmonic", "cVAE"], ROBOT, None)


def test_the_arms_process_of_a_study_loads_neither_training_nor_a_database() -> None:
    """It begins with every drive; torch alone takes it seconds, in which others wait for the processor."""
    heavy = {"torch", "sklearn", "pandas", "sqlalchemy", "starlette"}
    loads = (
        "import sys, latentarm_research.user_studies.serving.page_drive, latentarm.web.arm_process.process"
    )
    found = subprocess.run(
        [sys.executable, "-c", f"{loads}; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    assert not heavy & set(found.stdout.split())
