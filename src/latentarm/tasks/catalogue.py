"""The tasks that an arm can be driven at, by name: ours, and those that other distributions register."""

from collections.abc import Callable
from typing import Final, cast

from latentarm.errors import UserError
from latentarm.plugins import Catalogue
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.tasks.task import Task
from latentarm.types import StatedLimits


def _task(name: str, thing: object) -> type[Task]:
    if not (isinstance(thing, type) and issubclass(thing, Task)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.tasks.task.Task")
    return thing


TASKS: Final = Catalogue(
    "latentarm.tasks",
    "task",
    {
        "table_top": "latentarm.tasks.table_top:TableTop",
        "reach": "latentarm.tasks.reach:Reach",
        "planar_two_cups": "latentarm.tasks.two_cups:PlanarTwoCups",
        "panda_two_cups": "latentarm.tasks.two_cups:PandaTwoCups",
    },
    _task,
)
"""Each is made with a robot where it is for `Task.any_robot`, and without arguments otherwise."""

HELD_OUT: Final = "held_out"
"""Following the held-out episodes of a run, `Replay`: a task that only a run can make."""


def make_task(
    name: str,
    robot: str | None = None,
    end_effector: str | None = None,
    limits: StatedLimits | None = None,
    usual: Callable[[], Robot] | None = None,
) -> Task:
    """A task of the catalogue.

    Args:
        name: a name in `TASKS`.
        robot: a robot's name or model file; the task's own where None, else ``usual``.
        end_effector: site, body or link of a model file.
        limits: what is stated of the robot's limits.
        usual: the robot of a task for any robot where none is named; a Panda where None.

    Raises:
        UserError: there is no such task, it does not load, the robot cannot be loaded, or the task is for
            another robot.
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
