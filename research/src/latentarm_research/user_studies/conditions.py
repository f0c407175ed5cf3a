"""What a simulated person drives with in a condition."""

from functools import partial
from typing import Final

from latentarm.alignment.contract import identity
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.axis_modes import TWO_STICKS
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.robots.robot import Robot
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.assistance.published_help import Interpolation, published_belief
from latentarm_research.baselines.retargeting import RetargetingController
from latentarm_research.drives.drive import Setup
from latentarm_research.people.person import Person
from latentarm_research.user_studies.definition import Condition
from latentarm_research.user_studies.training import Trained

LINEAR_M_S: Final = 0.2
ANGULAR_RAD_S: Final = 0.4
"""Speeds of a full input without latent actions: those published with hindsight optimisation (Javdani et al.
2018)."""


def setup_of(
    condition: Condition, task: SceneTask, person: Person, trained: Trained | None, number: int
) -> Setup:
    """Everything that a trial of a condition is driven with."""
    return Setup(
        task,
        controller_of(condition, task.robot, trained, number),
        person,
        assistance_of(condition, task.robot),
        rule=belief_of(condition, task.robot),
    )


def controller_of(condition: Condition, robot: Robot, trained: Trained | None, number: int) -> Controller:
    """What turns a person's input into motion."""
    if condition.controls == "two_sticks":
        return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S, modes=TWO_STICKS)
    if condition.controls == "retargeting":
        return RetargetingController(robot, LINEAR_M_S, ANGULAR_RAD_S)
    if condition.controls == "modes":
        return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S)
    if trained is None:
        raise ValueError(f"the condition {condition.name} has no model")
    alignment = identity
    if condition.aligns != "none" and trained.aligned is not None:
        alignment = trained.aligned.alignments[condition.aligns][number]
    return LatentController(trained.decoder(condition), alignment)


def belief_of(condition: Condition, robot: Robot) -> Rule:
    """How inputs change the belief over goals: as the condition's help was published with."""
    return published_belief(robot) if condition.assists == "interpolation" else BoltzmannBelief


def assistance_of(condition: Condition, robot: Robot) -> AssistanceRule | None:
    """How the robot helps; None never helps."""
    if condition.assists == "blending":
        return blending(FixedAlpha())
    if condition.assists == "interpolation" and condition.weight:
        return partial(Interpolation, robot=robot, weight=condition.weight)
    return None
