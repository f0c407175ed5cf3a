"""The task that a run is driven at: the one it was trained for, or another."""

from dataclasses import replace
from typing import Literal

import numpy as np

from latentarm.demonstrations.split import select_episodes
from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.runs.folder import Run, robot_of
from latentarm.tasks.reach import Reach
from latentarm.tasks.replay import Replay
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task
from latentarm.types import Demonstrations, StatedLimits

TaskName = Literal["table_top", "held_out", "reach"]


def task_of_run(
    run: Run,
    demonstrations: Demonstrations,
    name: TaskName | None = None,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
) -> Task:
    """The task that is asked for, or else the one that a run was trained for.

    Args:
        run: the run.
        demonstrations: its dataset.
        name: the task; by the dataset's goals where None.
        robot: a robot's name or model file; that of the run where None.
        end_effector: site, body or link of a model file; that of the run where None.
        limits: what is stated of the robot's limits; what the run states where None.

    Raises:
        UserError: the robot is not to be had, or the task does not suit it, or has other goals than those
            that the run's decoder sees a belief over.
    """
    chosen = name or _usual_task(demonstrations)
    if chosen == "table_top":
        task: Task = _table_top(robot, end_effector, limits)
    else:
        if robot is None:
            chosen_tool, stated = end_effector or run.end_effector, limits or run.limits
            arm = robot_of(replace(run, end_effector=chosen_tool, limits=stated))
        else:
            arm = load_robot(robot, end_effector, limits)
        task = Reach(arm) if chosen == "reach" else Replay(arm, select_episodes(demonstrations, run.held_out))
    if run.context == "state_belief":
        _check_goals(run, demonstrations, task)
    return task


def task_without_run(
    name: TaskName | None = None,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
) -> Task:
    """The task that is asked for, or the table-top task for a Panda, and poses in reach for other arms.

    Args:
        name: the task.
        robot: a robot's name or model file; a Panda where None.
        end_effector: site, body or link of a model file.
        limits: what is stated of the robot's limits.

    Raises:
        UserError: the robot is not to be had, or the task does not suit it, or belongs to a run.
    """
    chosen = name or ("table_top" if robot in (None, "panda") else "reach")
    if chosen == "table_top":
        return _table_top(robot, end_effector, limits)
    if chosen == "reach":
        return Reach(load_robot(robot or "panda", end_effector, limits))
    raise UserError("Held-out episodes belong to a run: name one, as in `latentarm drive RUN`.")


def _table_top(robot: str | None, end_effector: str | None, limits: StatedLimits | None) -> TableTop:
    if robot not in (None, "panda"):
        raise UserError(f"The table-top task is set for the Panda, not for {robot}: use --task reach.")
    if end_effector is not None or limits is not None:
        raise UserError(
            "The table-top task has a Panda of its own: for another tool or limits use --task reach."
        )
    return TableTop()


def _usual_task(demonstrations: Demonstrations) -> TaskName:
    goals = {goal.name for goal in demonstrations.goals}
    return "table_top" if goals == {goal.name for goal in TableTop().goals} else "held_out"


def _check_goals(run: Run, demonstrations: Demonstrations, task: Task) -> None:
    """A decoder that sees a belief knows only the goals that it was trained with."""
    trained = [goal.configuration for goal in demonstrations.goals]
    here = [goal.configuration for goal in task.goals]
    if len(trained) != len(here) or not np.allclose(trained, here, atol=1e-6):
        raise UserError(
            f"{run.folder} sees a belief over the goals of its dataset, and the task {task.name} has others:"
            " drive it on the task that it was trained for."
        )
