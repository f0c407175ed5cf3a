"""What a simulated person drives with in a condition."""

from latentarm.alignment.contract import identity
from latentarm.control.controller import Controller
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.controllers.latent import LatentController
from latentarm.operators.person import Person
from latentarm.robots.robot import Robot
from latentarm.simulation.task_drive import TaskSetup
from latentarm.tasks.scene_task import SceneTask
from latentarm.user_studies.definition import Condition
from latentarm.user_studies.training import Trained


def setup_of(
    condition: Condition, task: SceneTask, person: Person, trained: Trained | None, number: int
) -> TaskSetup:
    """Everything that a trial of a condition is driven with.

    Args:
        condition: of the study.
        task: what is done.
        person: who drives.
        trained: models of the task; None for conditions without.
        number: of the person among those that were asked.
    """
    return TaskSetup(task, controller_of(condition, task.robot, trained, number), person)


def controller_of(condition: Condition, robot: Robot, trained: Trained | None, person: int) -> Controller:
    """What turns a person's input into motion.

    Args:
        condition: of the study.
        robot: the arm.
        trained: models of the task; None for conditions without.
        person: index of the person among those that were asked.
    """
    if condition.controls != "latent" or trained is None:
        return EndEffectorController(robot)
    alignment = identity
    if condition.aligns != "none" and trained.aligned is not None:
        alignment = trained.aligned.alignments[condition.aligns][person]
    return LatentController(trained.decoder(condition), alignment)
