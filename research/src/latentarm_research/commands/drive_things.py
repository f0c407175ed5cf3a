"""`latentarm drive` at a task with things: in physics, in steps."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import StepRecord
from latentarm.evaluation.results import as_document
from latentarm.evaluation.summary import Subject
from latentarm.robots.notices import notices
from latentarm.robots.robot import Robot
from latentarm.runs.folder import Run
from latentarm.runs.results_folder import ResultsFolder, write_json
from latentarm.tasks.catalogue import make_scene_task
from latentarm.tasks.scene_task import Beginning
from latentarm_research.commands.drive_options import Driven, DriveOptions
from latentarm_research.commands.drive_recording import check_recordable, counted, recording
from latentarm_research.commands.drive_steering import steering_of
from latentarm_research.drives.drive_figures import draw_drives, marks_of_first_steps
from latentarm_research.drives.drive_table import write_drives_csv
from latentarm_research.drives.task_drive import TaskSetup, TaskTrace
from latentarm_research.drives.task_drive_table import task_drive_entries
from latentarm_research.drives.task_drives import Series, drive_again, drive_series
from latentarm_research.metrics.task_drives import task_drive_rows

MADE: Final = ("drives.json", "drives.csv", "paths.png")
"""Every file of the folder except its options."""

OF_THE_TASK: Final = {
    "robot": "a robot of its own",
    "end_effector": "a robot of its own",
    "limits": "a robot of its own",
    "time_limit_s": "a time limit of its own",
}
"""What such a task decides itself, by the option that decides it elsewhere."""


def drive_with_things(
    config: DriveOptions, run: Run | None, name: str, tell: Callable[[Sequence[str]], None]
) -> Driven:
    """Drive for every choice of a task several times and write ``drives.json``, ``drives.csv`` and a figure.

    Args:
        config: what was asked for.
        run: the run that was named, or None.
        name: of the task, one of `latentarm.tasks.catalogue.SCENE_TASKS`.
        tell: called with notices about the robot before it moves.

    Raises:
        UserError: an option makes no sense at a task with things, the run does not fit the task, or the
            folder holds something else.
    """
    _check(config, name)
    task = make_scene_task(name)
    tell(notices(task.robot))
    steering = steering_of(config, run, name, task.robot)
    about = steering.about(task.time_limit_s)
    check_recordable(config)
    ResultsFolder("drive", MADE).claim(config.out, about)
    setup = TaskSetup(
        task,
        steering.controller,
        steering.person,
        steering.assistance,
        steering.arm,
        steering.rule,
    )
    series = Series([setup], config.drives)
    if config.record is None:
        (traces,) = drive_series([series], config.seed, config.jobs, bars=config.bars)
    else:
        traces = _record_all(series, config, config.record, task.robot, steering.controller)
    subject = Subject("drive", task=name, model=steering.model, condition=config.driver)
    rows = task_drive_rows(subject, [trace.measured for trace in traces])
    operator = steering.operator
    entries = task_drive_entries(
        task.choices,
        traces,
        drives=config.drives,
        seed=config.seed,
        controller=config.driver,
        operator=operator,
    )
    write_json(config.out / "drives.json", as_document(rows, about) | {"drives": entries})
    write_drives_csv(config.out / "drives.csv", entries)
    draw_drives({config.driver: traces}, marks_of_first_steps(traces), config.out / "paths.png")
    return Driven(rows, entries, config.driver, operator, name, task.time_limit_s)


def _check(config: DriveOptions, name: str) -> None:
    for option, its_own in OF_THE_TASK.items():
        if getattr(config, option) is not None:
            raise UserError(f"The task {name} has {its_own}: leave --{option.replace('_', '-')} out.")


def _record_all(
    series: Series, config: DriveOptions, dataset: Path, robot: Robot, controller: Controller
) -> list[TaskTrace]:
    """Drive one after the other and record every step, with where the things are."""
    traces: list[TaskTrace] = []
    with recording(config, dataset, robot, controller) as recorded:

        def begin(begun: Beginning) -> Callable[[StepRecord], None]:
            recorded.begin(begun.text, begun.goals, begun.scene.names, begun.objects)
            return recorded.step

        for index in counted(range(len(series.calls(config.seed))), config.bars):
            traces.append(drive_again(series, config.seed, index, record=begin))
            recorded.end()
    return traces
