"""`latentarm drive`: drive every choice of a task several times, and write what came of it."""

from collections.abc import Callable, Sequence
from typing import Final

from latentarm.core.errors import UserError
from latentarm.evaluation.results import as_document
from latentarm.evaluation.summary import Subject
from latentarm.robots.limits_file import read_limits
from latentarm.robots.notices import notices
from latentarm.runs.folder import Run, read_run
from latentarm.runs.results_folder import write_json
from latentarm.runs.tasks import task_of_run, task_without_run
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS, make_scene_task
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.task import Task
from latentarm_research.commands.drive_options import Driven, DriveOptions
from latentarm_research.commands.drive_recording import check_recordable, record_drives
from latentarm_research.commands.drive_steering import steering_of
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drive_figures import draw_drives, marks_of_first_steps, marks_of_goals
from latentarm_research.drives.drive_table import drive_entries, write_drives_csv
from latentarm_research.drives.drives import drive_all, plan_drives
from latentarm_research.metrics.drives import drive_rows
from latentarm_research.studies.results_folder import ResultsFolder

MADE: Final = ("drives.json", "drives.csv", "paths.png")
"""Every file of the folder except its options and a recording's journal."""

TIME_LIMIT_S: Final = 60.0  # how long a drive to a goal may last
HELD_OUT_LIMIT_S: Final = 300.0  # the same along held-out episodes, which are several metres long

OF_THE_TASK: Final = {
    "robot": "a robot of its own",
    "end_effector": "a robot of its own",
    "limits": "a robot of its own",
    "time_limit_s": "a time limit of its own",
}
"""Options that a task with things refuses, and what it has instead."""


def drive_run(config: DriveOptions, tell: Callable[[Sequence[str]], None] = lambda sentences: None) -> Driven:
    """Drive every choice of a task several times and write ``drives.json``, ``drives.csv`` and a figure."""
    run = None if config.run is None else read_run(config.run)
    in_each_manner = _tasks(config, run)
    task = in_each_manner[0]
    tell(notices(task.robot))
    steering = steering_of(config, run, task.name, task.robot)
    about = steering.about(task.time_limit_s)
    check_recordable(config)
    ResultsFolder("drive", MADE).claim(config.out, about)
    setups = [
        [Setup(one, steering.controller, steering.person, steering.assistance, steering.arm, steering.rule)]
        for one in in_each_manner
    ]
    planned = plan_drives(setups, config.drives, config.seed)
    if config.record is None:
        (traces,) = drive_all([planned], config.jobs, bars=config.bars)
    else:
        traces = record_drives(planned, config, config.record, task.robot, steering.controller)
    subject = Subject("drive", task=task.name, model=steering.model, condition=config.driver)
    rows = drive_rows(subject, [trace.figures for trace in traces])
    operator = steering.operator
    entries = drive_entries(planned, traces, controller=config.driver, operator=operator)
    write_json(config.out / "drives.json", as_document(rows, about) | {"drives": entries})
    write_drives_csv(config.out / "drives.csv", entries)
    marks = marks_of_goals(task.goals) if isinstance(task, GoalTask) else marks_of_first_steps(traces)
    draw_drives({config.driver: traces}, marks, config.out / "paths.png")
    return Driven(rows, entries, config.driver, operator, task.name, task.time_limit_s)


def _tasks(config: DriveOptions, run: Run | None) -> list[SceneTask]:
    """The task in each of its manners; one with things has one."""
    name = config.task or (None if run is None else run.task)
    if name is not None and name in SCENE_TASKS:
        for option, its_own in OF_THE_TASK.items():
            if getattr(config, option) is not None:
                raise UserError(f"The task {name} has {its_own}: leave --{option.replace('_', '-')} out.")
        return [make_scene_task(name)]
    task = _task_at_goals(config, run)
    limit_s = config.time_limit_s or (HELD_OUT_LIMIT_S if task.name == HELD_OUT else TIME_LIMIT_S)
    return [GoalTask(task, manner, limit_s) for manner in task.manners]


def _task_at_goals(config: DriveOptions, run: Run | None) -> Task:
    limits = None if config.limits is None else read_limits(config.limits)
    if run is None:
        return task_without_run(config.task, config.robot, config.end_effector, limits)
    return task_of_run(run, config.task, config.robot, config.end_effector, limits, config.demonstrations)
