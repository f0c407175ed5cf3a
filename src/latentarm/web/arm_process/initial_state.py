"""How a run of a task begins: with things in physics, without any, or about a real arm."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.arms.catalogue import make_scene_arm
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, StatedLimits
from latentarm.robots.assemble import restate
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import read_limits
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene
from latentarm.runs.folder import Run
from latentarm.runs.tasks import task_of_run, task_without_run
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.place import Place
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.web.arm_process.task_run import Todo, goal_to_reach, things_to_do

FREE: Final = "free"  # name of the task where none is named: nothing in particular is to be done
MOST_THINGS: Final = 200
MOST_GRAINS: Final = 2000  # largest numbers that fit into a tick's report


@final
@dataclass(frozen=True)
class RobotOptions:
    """Which robot is driven, where neither run nor task says so; ``end_effector`` is of a model file."""

    robot: str | None = None
    end_effector: str | None = None
    limits: Path | None = None

    @property
    def stated(self) -> StatedLimits | None:
        """The limits file's content. Raises UserError if the file cannot be read."""
        return None if self.limits is None else read_limits(self.limits)


@final
@dataclass(frozen=True, eq=False)
class InitialState:
    """The initial state of a task run."""

    place: Place
    start: FloatArray  # (n,), where a simulated arm starts, and where the way back leads, rad
    todo: Todo
    scene: Scene | None = None  # the things about the arm; None where they do not count


def begin(
    run: Run | None, task: str | None, arm: str, choice: int, robot: RobotOptions, rng: np.random.Generator
) -> InitialState:
    """Begin with a simulated arm; the same for equal arguments.

    ``task`` is None for the run's own, or a table; ``choice`` is an index of what is to be done. Raises
    UserError if any of these does not exist, or they do not fit each other.
    """
    if task is not None and task in SCENE_TASKS:
        with_things = make_scene_task(task)
        _check_own_robot(task, with_things.robot, robot)
        _check_choice(choice, with_things.choices)
        return with_scene(with_things, choice, with_things.begin(choice, rng), arm)
    named = (robot.robot, robot.end_effector, robot.stated)
    made = task_without_run(task, *named) if run is None else task_of_run(run, task, *named, option=False)
    _check_choice(choice, made.goals)
    place = Place(made.robot, made.goals, tuple(made.obstacles), shown=made.shown)
    return InitialState(place, made.sample_start(choice, rng), goal_to_reach(made, choice))


def with_scene(task: SceneTask, choice: int, begun: Beginning, arm: str) -> InitialState:
    """A simulated arm among a task's things. Raises UserError if it can touch none, or they are too many."""
    _check_things(task.name, begun.scene)
    # Made here too, so that an arm that can touch nothing is refused where the command was typed.
    make_scene_arm(arm, task.robot, begun.state, lambda: 0.0, begun.scene)
    place = Place(task.robot, begun.goals, task.obstacles, begun.objects)
    return InitialState(place, begun.state, things_to_do(task, choice, begun), begun.scene)


def begin_real(run: Run | None, task: str | None, choice: int, robot: RobotOptions) -> InitialState:
    """Begin with a real arm, wherever it is.

    Of a task with things the robot, its obstacles and the shapes of its things count; goals are those of a
    run's demonstrations, or of a task that was named. ``task`` is None for the run's own, or for nothing in
    particular. Raises UserError if neither a run nor a robot is named, any of these
    does not exist, or they do not fit each other.
    """
    if run is None and robot.robot is None:
        raise UserError(
            "A real arm is driven only as a robot that you name: add --robot NAME_OR_FILE, or a trained run,"
            " which knows its robot."
        )
    if task is not None and task in SCENE_TASKS:
        with_things = make_scene_task(task)
        _check_own_robot(task, with_things.robot, robot)
        arm = with_things.robot if robot.stated is None else restate(with_things.robot, robot.stated)
        _check_choice(choice, with_things.choices)
        # The places that are drawn here are none of this room's: only shapes, heights and tilts count.
        begun = with_things.begin(choice, np.random.default_rng(0))
        scene = Scene(tuple(begun.scene.thing(name) for name in begun.objects), table_m=begun.scene.table_m)
        return _free(arm, Place(arm, (), tuple(with_things.obstacles), begun.objects), scene)
    if run is None and task is None and robot.robot is not None:
        arm = load_robot(robot.robot, robot.end_effector, robot.stated)
        return _free(arm, Place(arm, (), ()))
    named = (robot.robot, robot.end_effector, robot.stated)
    made = task_without_run(task, *named) if run is None else task_of_run(run, task, *named, option=False)
    _check_choice(choice, made.goals)
    place = Place(made.robot, made.goals, tuple(made.obstacles))
    return InitialState(place, made.robot.home, goal_to_reach(made, choice))


def _free(robot: Robot, place: Place, scene: Scene | None = None) -> InitialState:
    return InitialState(place, robot.home, Todo(FREE, (), 0, ()), scene)


def _check_own_robot(task: str, own: Robot, options: RobotOptions) -> None:
    if options.robot not in (None, own.name) or options.end_effector is not None:
        raise UserError(
            f"The task {task} has a robot of its own, {own.name}: name no other with --robot, and no"
            " --end-effector."
        )


def _check_choice(choice: int, choices: Sequence[object]) -> None:
    if not 0 <= choice < max(len(choices), 1):
        raise UserError(f"There are {len(choices)} things to choose from, from 0 on, and no choice {choice}.")


def _check_things(task: str, scene: Scene) -> None:
    grains = sum(len(one.positions) for one in scene.grains)
    if len(scene.things) > MOST_THINGS or grains > MOST_GRAINS:
        raise UserError(
            f"The task {task} has {len(scene.things)} things and {grains} grains: the page shows"
            f" {MOST_THINGS} and {MOST_GRAINS} at most."
        )
