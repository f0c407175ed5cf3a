"""`latentarm reproduce tasks`: tasks with things in physics, shown and driven by simulated people."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from latentarm.simulation.guide import GuidingHand
from latentarm.simulation.task_drive import REARM_S, STUCK_S
from latentarm.studies.page import render_page
from latentarm.studies.study import Grid, Report, Request, Study, again
from latentarm.studies.tasks.cell import (
    DriveCell,
    Shown,
    ShownCell,
    Trained,
    TrainingCell,
    blocks,
    drive,
    show,
    train,
    training_set,
)
from latentarm.studies.tasks.figures import steps_figure
from latentarm.studies.tasks.moved import MOVED, TASKS, task_of
from latentarm.studies.tasks.preset import PRESETS, Preset, Stream
from latentarm.studies.tasks.rows import STUDY as NAME
from latentarm.studies.tasks.rows import Measured, rows_of, runs_as_json
from latentarm.studies.tasks.runs import DEMONSTRATOR, SWITCHING, Condition, Driver, Run
from latentarm.studies.tasks.tables import failure_table, measure_table, summary_tables
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _measure(request: Request[Preset], grid: Grid) -> Measured:
    preset, seed = request.preset, request.seed
    shown = grid.run("Demonstrations", show, _shown_cells(request), _shown_label)
    training = [
        TrainingCell(task, model, context, demonstrations, preset, seed)
        for task, demonstrations in (
            (task, training_set(task, _trains(shown, task))) for task in request.tasks
        )
        for model in preset.models
        for context in (preset.moved_contexts if task in MOVED else (preset.context,))
    ]
    trained = grid.run("Models", train, training, lambda cell: f"{cell.task}, {cell.model}, {cell.context}")
    driven = grid.run("Drives", drive, _drive_cells(request, trained), _drive_label)
    return Measured(shown, trained, driven)


def _shown_cells(request: Request[Preset]) -> list[ShownCell]:
    preset = request.preset
    return [
        ShownCell(task, stream, numbers, request.seed)
        for task in request.tasks
        for stream, count in (
            (Stream.DEMONSTRATIONS, preset.demonstrations),
            (Stream.RUNS, preset.runs),
        )
        for numbers in blocks(count, preset.block)
    ]


def _trains(shown: Sequence[Shown], task: str) -> list[Shown]:
    return [one for one in shown if (one.cell.task, one.cell.stream) == (task, Stream.DEMONSTRATIONS)]


def _drive_cells(request: Request[Preset], trained: Sequence[Trained]) -> list[DriveCell]:
    preset = request.preset
    return [
        DriveCell(task, driver, preset.person, numbers, request.seed)
        for task in request.tasks
        for driver in (
            Driver(Condition(SWITCHING)),
            *(one.driver for one in trained if one.task == task),
        )
        for numbers in blocks(preset.runs, preset.block)
    ]


def _shown_label(cell: ShownCell) -> str:
    return f"{cell.task}, {DEMONSTRATOR}, {cell.stream.name.lower()} {_span(cell.numbers)}"


def _drive_label(cell: DriveCell) -> str:
    return f"{cell.task}, {cell.driver.condition.label}, runs {_span(cell.numbers)}"


def _span(numbers: range) -> str:
    return f"{numbers[0]} to {numbers[-1]}"


def _report(request: Request[Preset], measured: Measured) -> Report:
    by_task = {task: measured.runs(task) for task in request.tasks}
    rows = rows_of(by_task)
    figures = {"steps": steps_figure(by_task)}
    return Report(
        rows=rows,
        page=_page(request, measured, by_task, rows, figures),
        figures=figures,
        documents={"runs.json": runs_as_json(by_task)},
        timings=_timings(measured),
        tables=summary_tables(rows, by_task),
        models={one.folder: one.model for one in measured.trained},
    )


def _page(
    request: Request[Preset],
    measured: Measured,
    by_task: Mapping[str, Mapping[Condition, Sequence[Run]]],
    rows: Sequence[Row],
    figures: "Mapping[str, Figure]",
) -> str:
    tasks = {name: task_of(name, Stream.RUNS) for name in by_task}
    return render_page(
        "tasks/page.md",
        command=again(STUDY, request),
        preset=request.preset,
        figures=figures,
        hand=GuidingHand(),
        stuck_s=STUCK_S,
        rearm_s=REARM_S,
        tasks=tasks,
        moved={name: MOVED[name].about for name in tasks if name in MOVED},
        demonstrated={name: measured.demonstrated(name) for name in tasks},
        measure_tables={name: measure_table(rows, runs, name) for name, runs in by_task.items()},
        failure_tables={name: failure_table(runs) for name, runs in by_task.items()},
    )


def _timings(measured: Measured) -> dict[str, object]:
    """How long models were fitted and each condition was driven, s."""
    drives: dict[tuple[str, str], float] = {}
    for one in measured.driven:
        place = one.task, one.condition.label
        drives[place] = drives.get(place, 0.0) + one.drive_s
    return {
        "models": [
            {"task": one.task, "condition": one.condition.label, "fit_s": one.fit_s}
            for one in measured.trained
        ],
        "drives": [
            {"task": task, "condition": condition, "drive_s": drive_s}
            for (task, condition), drive_s in drives.items()
        ],
    }


STUDY: Final = Study(
    name=NAME,
    command="reproduce tasks",
    presets=PRESETS,
    tasks=TASKS,
    simulated=("arms", "people", "things"),
    measure=_measure,
    report=_report,
    figures=("steps",),
    documents=("runs.json",),
)
