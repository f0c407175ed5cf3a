"""The task that a run is driven at: the one it was trained for, or another."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np

from latentarm.arms.catalogue import DEFAULT_ARM, PHYSICAL_ARM
from latentarm.core.context import BELIEF, GRIPPER, Named, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, StatedLimits
from latentarm.demonstrations.gripper import ACTION_GRIPPER, opening_source
from latentarm.demonstrations.split import select_episodes
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.runs.folder import Run, robot_of
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS, TASKS
from latentarm.tasks.replay import Replay, gripper_routes_of, routes_of
from latentarm.tasks.table_top import ITEMS
from latentarm.tasks.task import Task


def task_of_run(
    run: Run,
    name: str | None = None,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
    dataset: Path | None = None,
    *,
    option: bool = True,
) -> Task:
    """The task of this name, or else the one that a run was trained for.

    The dataset, at ``dataset`` if it was moved, is read only for parts that the run does not keep: of runs of
    earlier versions the task and the goals, and the held-out episodes where another robot or end-effector is
    to follow them. Robot, end-effector and limits are those of the run where None. ``option`` tells whether
    the user can name the dataset with ``--demonstrations``.

    Raises UserError where the robot or the dataset cannot be loaded, or the task does not suit the robot, or
    has other goals than those of a decoder that sees a belief.
    """
    kept = run.task
    if kept is None:
        seen = run.dataset(dataset, "its task", option)
        kept = usual_task(seen)
        run = replace(run, goals=seen.goals, task=kept)
    chosen = name or kept
    stated = replace(run, end_effector=end_effector or run.end_effector, limits=limits or run.limits)
    if chosen == HELD_OUT:
        arm = robot_of(stated) if robot is None else load_robot(robot, end_effector, limits)
        own = robot is None and end_effector in (None, run.end_effector)
        routes, open_at = run.routes if own else None, run.open_at
        if routes is None:
            demonstrations = run.dataset(dataset, "its held-out episodes", option)
            held_out = select_episodes(demonstrations, run.held_out)
            routes, open_at = routes_seen(arm, held_out, run.context)
        task: Task = Replay(arm, routes, open_at)
    else:
        task = make_task(chosen, robot, end_effector, limits, usual=lambda: robot_of(stated))
    if BELIEF in run.context:
        _check_goals(run, task)
    return task


def task_without_run(
    name: str | None = None,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
) -> Task:
    """The task of this name, or the table-top task for a Panda, and poses in reach for other arms.

    Raises UserError where the robot is not available, or the task does not suit it, or belongs to a run.
    """
    chosen = name or ("table_top" if robot in (None, "panda") else "reach")
    if chosen == HELD_OUT:
        raise UserError("Held-out episodes belong to a run: name one, as in `latentarm drive RUN`.")
    return make_task(chosen, robot, end_effector, limits)


def make_task(
    name: str,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
    usual: Callable[[], Robot] | None = None,
) -> Task:
    """A task of the catalogue, by its name in `TASKS`.

    ``robot`` is a robot's name or model file; where None, the task's own or, for tasks of any robot,
    ``usual`` or a Panda. ``end_effector`` is a site, body or link of a model file.

    Raises UserError where there is no such task, it does not load, the robot cannot be loaded, or the task is
    for another robot.
    """
    task_class = TASKS.find(name, "--task")
    if task_class.any_robot:
        if usual is not None and robot is None:
            made_for = usual()
        else:
            made_for = load_robot(robot or "panda", end_effector, limits)
        return cast(Callable[[Robot], Task], task_class)(made_for)
    task = cast(Callable[[], Task], task_class)()
    if robot not in (None, task.robot.name):
        raise UserError(
            f"The task {name} is for the robot {task.robot.name}, not for {robot}: use --task reach."
        )
    if end_effector is not None or limits is not None:
        raise UserError(
            f"The task {name} has a {task.robot.name} of its own: for another tool or other limits use"
            " --task reach."
        )
    return task


def routes_seen(
    robot: Robot, demonstrations: Demonstrations, context: Named
) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
    """The routes and gripper openings of demonstrations, for a model with this context to follow.

    See `routes_of` and `GripperRoutes`. The gripper opens and closes on the way only where the model sees its
    command.

    Raises UserError where the tool goes nowhere in any of them.
    """
    told = all(opening_source(one.extras) == ACTION_GRIPPER for one in demonstrations.episodes)
    if GRIPPER in feature_names(context) and told and robot.gripper is not None:
        half_m = robot.gripper.width_m / 2.0
        found = gripper_routes_of(
            robot, demonstrations, lambda episode: episode.extras[ACTION_GRIPPER][:, 0] > half_m
        )
        return found.states, found.open_at
    return routes_of(robot, demonstrations), ()


def usual_task(demonstrations: Demonstrations) -> str:
    """The task at which all episodes were recorded, as far as they say; else that of the goals."""
    named = {one.provenance.task_name for one in demonstrations.episodes if one.provenance is not None} - {""}
    if len(named) == 1 and named <= {*TASKS, *SCENE_TASKS}:
        return named.pop()
    return "table_top" if {goal.name for goal in demonstrations.goals} == set(ITEMS) else HELD_OUT


def usual_arm(task: str | None) -> str:
    """The default arm: only in physics are things touched and held. A task not yet known (None) has none."""
    return PHYSICAL_ARM if task in SCENE_TASKS else DEFAULT_ARM


def _check_goals(run: Run, task: Task) -> None:
    """Refuse a task with other goals than those of a decoder that sees a belief."""
    trained = [goal.configuration for goal in run.goals]
    here = [goal.configuration for goal in task.goals]
    if np.shape(trained) != np.shape(here) or not np.allclose(trained, here, atol=1e-6):
        raise UserError(
            f"{run.folder} sees a belief over the goals of its dataset, and the task {task.name} has others:"
            " drive it on the task that it was trained for."
        )
