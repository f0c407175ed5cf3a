"""What a simulated person drives with in a condition."""

from functools import partial
from typing import Final

from latentarm.alignment.contract import identity
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.catalogue import published_assistance, published_belief
from latentarm.assistance.interpolation import Interpolation
from latentarm.control.controller import Controller
from latentarm.controllers.end_effector import TWO_STICKS, EndEffectorController
from latentarm.controllers.latent import LatentController
from latentarm.operators.person import Person
from latentarm.robots.robot import Robot
from latentarm.simulation.task_drive import TaskSetup
from latentarm.tasks.scene_task import SceneTask
from latentarm.user_studies.definition import Condition
from latentarm.user_studies.training import Trained

LINEAR_M_S: Final = 0.2
ANGULAR_RAD_S: Final = 0.4
"""Speeds of a full input without latent actions: those published with hindsight optimisation (Javdani et al.
2018)."""


def setup_of(
    condition: Condition, task: SceneTask, person: Person, trained: Trained | None, number: int
) -> TaskSetup:
    """Everything that a trial of a condition is driven with.

    The robot believes by the same rule in every condition, as in the demonstrations that models learned from.

    Args:
        condition: of the study.
        task: what is done.
        person: who drives.
        trained: models of the task; None for conditions without.
        number: of the person among those that were asked.
    """
    return TaskSetup(
        task,
        controller_of(condition, task.robot, trained, number),
        person,
        assistance_of(condition, task.robot),
        rule=published_belief(task.robot),
    )


def controller_of(condition: Condition, robot: Robot, trained: Trained | None, number: int) -> Controller:
    """What turns a person's input into motion.

    Args:
        condition: of the study.
        robot: the arm.
        trained: models of the task; None for conditions without.
        number: of the person among those that were asked.
    """
    if trained is not None and condition.controls == "latent":
        alignment = identity
        if condition.aligns != "none" and trained.aligned is not None:
            alignment = trained.aligned.alignments[condition.aligns][number]
        return LatentController(trained.decoder(condition), alignment)
    if condition.controls == "two_sticks":
        return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S, modes=TWO_STICKS)
    return EndEffectorController(robot, LINEAR_M_S, ANGULAR_RAD_S)


def assistance_of(condition: Condition, robot: Robot) -> AssistanceRule | None:
    """How the robot helps; None never helps.

    Args:
        condition: of the study.
        robot: the arm.
    """
    if condition.assists == "hindsight":
        return published_assistance("hindsight", robot)
    if condition.assists == "interpolation" and condition.weight:
        return partial(Interpolation, robot=robot, weight=condition.weight)
    return None
