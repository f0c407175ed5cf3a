"""`latentarm reproduce tasks`: tasks with things in physics, shown and driven by simulated people."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm_research.drives.drive import REARM_S
from latentarm_research.drives.guide import GuidingHand
from latentarm_research.metrics.ending import STUCK_S
from latentarm_research.studies import fitting, streams
from latentarm_research.studies.page import render_page
from latentarm_research.studies.results_folder import package_versions, source_digest
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.studies.tasks import cell as measuring
from latentarm_research.studies.tasks import kept, moved, orientation, runs, tables
from latentarm_research.studies.tasks import preset as presets
from latentarm_research.studies.tasks.cell import (
    ModelCell,
    ShownCell,
    TaskRunCell,
    drive,
    show,
    train,
    training_set,
)
from latentarm_research.studies.tasks.figures import success_figure
from latentarm_research.studies.tasks.moved import MOVED, TASKS, task_of
from latentarm_research.studies.tasks.orientation import orient
from latentarm_research.studies.tasks.preset import (
    DEMONSTRATOR,
    ORIENTED,
    PRESETS,
    SWITCHING,
    Condition,
    Preset,
    Stream,
)
from latentarm_research.studies.tasks.rows import STUDY as NAME
from latentarm_research.studies.tasks.rows import ByTask, TasksResults, rows_of, runs_as_json
from latentarm_research.studies.tasks.rule import DefaultVerdict, decide
from latentarm_research.studies.tasks.runs import Driver

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _measure(request: Request[Preset], grid: Grid) -> TasksResults:
    preset, seed = request.preset, request.seed
    shown = grid.run("Demonstrations", show, _shown_cells(request), _shown_label, kept.KEEP_SHOWN)
    training = [one for one in shown if one.cell.stream is Stream.DEMONSTRATIONS]
    sets = {
        task: training_set(task, [one for one in training if one.cell.task == task]) for task in request.tasks
    }
    fits = [
        ModelCell(task, Condition(context, model, way_back), demonstrations, preset, seed)
        for task, demonstrations in sets.items()
        for model in preset.models
        for context in (preset.moved_contexts if task in MOVED else (preset.context,))
        for way_back in (False, True)
    ]
    trained = grid.run(
        "Models", train, fits, lambda cell: f"{cell.task}, {cell.condition.label}", kept.KEEP_MODELS
    )
    orienting = [
        ModelCell(task, Condition(ORIENTED), demonstrations, preset, seed)
        for task, demonstrations in sets.items()
    ]
    oriented = grid.run("Orientations", orient, orienting, lambda cell: cell.task)
    drivers = {
        cell.task: [Driver(cell.condition, orientation=one)]
        for cell, one in zip(orienting, oriented, strict=True)
    }
    for one in trained:
        drivers[one.task].append(one.driver)
    cells = _drive_cells(request, drivers)
    driven = grid.run("Drives", drive, cells, _drive_label, kept.KEEP_DRIVES)
    return TasksResults(shown, trained, list(zip(cells, driven, strict=True)))


def _shown_cells(request: Request[Preset]) -> list[ShownCell]:
    preset = request.preset
    return [
        ShownCell(task, stream, number, request.seed)
        for task in request.tasks
        for stream, count in (
            (Stream.DEMONSTRATIONS, preset.demonstrations),
            (Stream.RUNS, preset.runs),
        )
        for number in range(count)
    ]


def _drive_cells(request: Request[Preset], learned: Mapping[str, Sequence[Driver]]) -> list[TaskRunCell]:
    """Number by number, so that a study that was stopped has as many runs of each condition."""
    preset = request.preset
    return [
        TaskRunCell(task, driver, person, number, request.seed)
        for number in range(preset.runs)
        for task in request.tasks
        for driver in _drivers(learned[task], preset)
        if number < preset.others or driver.condition in (Condition(SWITCHING), preset.default, preset.page)
        for person in preset.people
    ]


def _drivers(learned: Sequence[Driver], preset: Preset) -> list[Driver]:
    """All controllers of a task: mode switching, every model, and the default beside mode switching."""
    page = [replace(one, condition=preset.page) for one in learned if one.condition == preset.default]
    return [Driver(Condition(SWITCHING)), *learned, *page]


def _shown_label(cell: ShownCell) -> str:
    return f"{cell.task}, {DEMONSTRATOR}, {cell.stream.name.lower()} {cell.number}"


def _drive_label(cell: TaskRunCell) -> str:
    return f"{cell.task}, {cell.driver.condition.label}, {cell.person}, run {cell.number}"


def _report(request: Request[Preset], measured: TasksResults) -> Report:
    by_task = measured.by_task(request.tasks)
    verdict = decide(by_task, measured.fit_s(request.preset.context))
    rows = rows_of(by_task)
    figures = {"success": success_figure(by_task)}
    return Report(
        rows=rows,
        page=_page(request, measured, by_task, rows, figures, verdict),
        figures=figures,
        documents={"runs.json": runs_as_json(by_task), "verdict.json": verdict.as_json()},
        tables=[*tables.summary_tables(by_task), f"Default by the rule: {verdict.sentence}."],
    )


def _page(
    request: Request[Preset],
    measured: TasksResults,
    by_task: ByTask,
    rows: Sequence[Row],
    figures: "Mapping[str, Figure]",
    verdict: DefaultVerdict,
) -> str:
    tasks = {name: task_of(name, Stream.RUNS) for name in by_task}
    return render_page(
        "tasks/page.md",
        command=again(STUDY, request),
        preset=request.preset,
        figures=figures,
        verdict=verdict,
        hand=GuidingHand(),
        stuck_s=STUCK_S,
        rearm_s=REARM_S,
        tasks=tasks,
        moved={name: MOVED[name].about for name in tasks if name in MOVED},
        demonstrated={name: measured.demonstrated(name) for name in tasks},
        refused=[
            f"{look_of(one.task).label} ({one.condition.label})" for one in measured.trained if one.refused
        ],
        success_tables={name: tables.success_table(runs) for name, runs in by_task.items()},
        time_tables={name: tables.time_table(runs) for name, runs in by_task.items()},
        measure_tables={name: tables.measure_table(rows, runs, name) for name, runs in by_task.items()},
        failure_tables={name: tables.failure_table(runs) for name, runs in by_task.items()},
    )


def _depends_on(request: Request[Preset]) -> dict[str, object]:
    """The code that measures a cell, so that a study does not go on with other code."""
    modules = [
        Path(module.__file__ or "")
        for module in (measuring, fitting, moved, orientation, presets, runs, streams)
    ]
    return {"code": source_digest(modules), "versions": package_versions()}


STUDY: Final = Study(
    name=NAME,
    command="reproduce tasks",
    presets=PRESETS,
    tasks=TASKS,
    simulated=("arms", "people", "things"),
    measure=_measure,
    report=_report,
    figures=("success",),
    documents=("runs.json", "verdict.json"),
    depends_on=_depends_on,
    kept=(kept.RUNS, kept.MODELS),
    options=("people", "runs"),
    grows=("people", "runs"),
)
