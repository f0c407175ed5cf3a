"""`latentarm drive` at a task with goals; one with things is passed on."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from latentarm.evaluation.results import as_document
from latentarm.evaluation.summary import Subject
from latentarm.robots.limits_file import read_limits
from latentarm.robots.notices import notices
from latentarm.runs.folder import Run, read_run
from latentarm.runs.results_folder import ResultsFolder, write_json
from latentarm.runs.tasks import task_of_run, task_without_run
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS
from latentarm.tasks.task import Task
from latentarm_research.commands.drive_options import Driven, DriveOptions
from latentarm_research.commands.drive_recording import check_recordable, counted, recording
from latentarm_research.commands.drive_steering import steering_of
from latentarm_research.commands.drive_things import drive_with_things
from latentarm_research.drives.drive import Setup, Trace, simulate
from latentarm_research.drives.drive_figures import draw_drives, marks_of_goals
from latentarm_research.drives.drive_table import Planned, drive_entries, write_drives_csv
from latentarm_research.drives.drives import drive_all, drive_plan
from latentarm_research.metrics.drives import goal_drive_rows

MADE: Final = ("drives.json", "drives.csv", "paths.png")
"""Every file of the folder except its options and a recording's journal."""

TIME_LIMIT_S: Final = 60.0
"""How long a drive may last."""

HELD_OUT_LIMIT_S: Final = 300.0
"""The same along held-out episodes, which are several metres long."""


def drive_run(config: DriveOptions, tell: Callable[[Sequence[str]], None] = lambda sentences: None) -> Driven:
    """Drive every goal of a task several times and write ``drives.json``, ``drives.csv`` and a figure.

    Args:
        config: what was asked for.
        tell: called with notices about the robot before it moves.

    Raises:
        UserError: the run, the robot or the task does not exist, they do not fit each other, or the folder
            holds something else.
    """
    run = None if config.run is None else read_run(config.run)
    name = config.task or (None if run is None else run.task)
    if name is not None and name in SCENE_TASKS:
        return drive_with_things(config, run, name, tell)
    task = _task(config, run)
    tell(notices(task.robot))
    steering = steering_of(config, run, task.name, task.robot)
    setup = Setup(
        task=task,
        controller=steering.controller,
        assistance=steering.assistance,
        person=steering.person,
        time_limit_s=config.time_limit_s or (HELD_OUT_LIMIT_S if task.name == HELD_OUT else TIME_LIMIT_S),
        rule=steering.rule,
        arm=steering.arm,
    )
    about = steering.about(setup.time_limit_s)
    check_recordable(config)
    ResultsFolder("drive", MADE).claim(config.out, about)
    if config.record is None:
        traces = drive_all([setup], config.drives, config.seed, config.jobs, bars=config.bars)
    else:
        traces = _record_all(setup, config, config.record)
    subject = Subject("drive", task=task.name, model=steering.model, condition=config.driver)
    rows = goal_drive_rows(subject, [trace.measured for trace in traces])
    planned = [
        Planned(task.goals[goal].name, manner, number % config.drives)
        for number, (goal, manner, _) in enumerate(drive_plan(task, config.drives, config.seed))
    ]
    operator = steering.operator
    entries = drive_entries(planned, traces, seed=config.seed, controller=config.driver, operator=operator)
    write_json(config.out / "drives.json", as_document(rows, about) | {"drives": entries})
    write_drives_csv(config.out / "drives.csv", entries)
    draw_drives({config.driver: traces}, marks_of_goals(task.goals), config.out / "paths.png")
    return Driven(rows, entries, config.driver, operator, task.name, setup.time_limit_s)


def _task(config: DriveOptions, run: Run | None) -> Task:
    limits = None if config.limits is None else read_limits(config.limits)
    if run is None:
        return task_without_run(config.task, config.robot, config.end_effector, limits)
    return task_of_run(run, config.task, config.robot, config.end_effector, limits, config.demonstrations)


def _record_all(setup: Setup, config: DriveOptions, dataset: Path) -> list[Trace]:
    """Drive one after the other and record every step."""
    task = setup.task
    traces: list[Trace] = []
    plan = drive_plan(task, config.drives, config.seed)
    with recording(config, dataset, task.robot, setup.controller) as recorded:
        for goal, manner, rng in counted(plan, config.bars):
            recorded.begin(f"{manner} {task.goals[goal].name}", task.goals)
            traces.append(simulate(setup, goal, manner, rng, recorded.step))
            recorded.end()
    return traces
