"""Controllers, beliefs and help of a study's conditions; the arm's process loads this, and no training."""

from functools import partial
from typing import Final

from latentarm.alignment.contract import Alignment, identity
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.axis_modes import TWO_STICKS
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.models.decoder import Decoder
from latentarm.robots.robot import Robot
from latentarm_research.assistance.published_help import Interpolation, published_belief
from latentarm_research.baselines.retargeting import RetargetingController
from latentarm_research.user_studies.definition import Condition

LINEAR_M_S: Final = 0.2
ANGULAR_RAD_S: Final = 0.4
"""Speeds of a full input without latent actions: those published with hindsight optimisation (Javdani et al.
2018)."""


def controller_of(
    condition: Condition, robot: Robot, decoder: Decoder | None, alignment: Alignment = identity
) -> Controller:
    """The condition's controller; without latent actions it needs no decoder."""
    if condition.controls == "two_sticks":
        return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S, modes=TWO_STICKS)
    if condition.controls == "retargeting":
        return RetargetingController(robot, LINEAR_M_S, ANGULAR_RAD_S)
    if condition.controls == "modes":
        return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S)
    if decoder is None:
        raise ValueError(f"the condition {condition.name} has no model")
    return LatentController(decoder, alignment)


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
