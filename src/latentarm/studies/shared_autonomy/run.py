"""`latentarm reproduce shared-autonomy`: simulated people reach and change goals (section 8.2), as a page."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Final

from latentarm.metrics.results import write_results
from latentarm.parallel.grid import check_processes, run_grid
from latentarm.runs.checks import check_seed
from latentarm.runs.results_folder import Study, write_json
from latentarm.studies.shared_autonomy.ablations import variants
from latentarm.studies.shared_autonomy.cell import (
    TASKS,
    WITH_ENTROPY,
    WITH_HELP,
    WITHOUT_HELP,
    Cell,
    CellResult,
    Entropy,
    measure_cell,
)
from latentarm.studies.shared_autonomy.figures.draw import FIGURES, draw_figures
from latentarm.studies.shared_autonomy.hypotheses import compare_methods
from latentarm.studies.shared_autonomy.intervals import band
from latentarm.studies.shared_autonomy.page import write_page
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.studies.shared_autonomy.rows import STUDY, Figure, figures, rows_of
from latentarm.studies.tasks import check_tasks
from latentarm.types import Row
from latentarm.untrusted.console import VisibleConsole

MODELS: Final = (MODEL, "cvae", "isometric")
"""The paper's model, that of its equation 16 in full, and ours."""

MADE: Final = (
    "results.json",
    "results.md",
    "seeds.json",
    "courses.json",
    "hypotheses.json",
    "timings.json",
    *(f"{name}.png" for name in FIGURES),
)
"""Every file of the folder, beside what was asked for."""


@dataclass(frozen=True)
class SharedAutonomyConfig:
    """What `latentarm reproduce shared-autonomy` was asked for.

    Attributes:
        out: a new folder, or that of an earlier run of this study, which is replaced.
        preset: sizes of the study.
        tasks: names in `TASKS`.
        seed: of everything random.
        jobs: processes side by side; -1 is one per core.
        backend: where they run, a name in `latentarm.parallel.backends.BACKENDS`.
        quiet: say nothing while working.
        bars: show how far the grid is.

    Raises:
        UserError: there are no tasks, one is unknown or named twice, or seed, jobs or backend are out of
            range.
    """

    out: Path
    preset: Preset
    tasks: tuple[str, ...] = tuple(TASKS)
    seed: int = 0
    jobs: int = -1
    backend: str = "joblib"
    quiet: bool = False
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, self.backend)
        check_tasks(self.tasks, TASKS)


def run_shared_autonomy(config: SharedAutonomyConfig) -> list[Row]:
    """Measure every cell of the study and write figures, tables and tests to ``config.out``.

    ``results.json`` depends on preset, tasks and seed alone; how long it took stands in ``timings.json``.

    Returns:
        Every measure of every method and person, for each arm and model, and of every variant of the entropy;
        mean and SD are over seeds where there are three or more, and over drives otherwise.

    Raises:
        UserError: the folder holds something else or cannot be written, the backend is not to be had, or a
            cell cannot be measured as asked; then it says which.
    """
    Study(STUDY, MADE).claim(config.out, _about(config))
    console = VisibleConsole(stderr=True, quiet=config.quiet)
    cells = _cells(config)
    console.print(
        f"1/2  {len(MODELS)} models, with entropy and without, {len(config.preset.people)} kinds of people,"
        f" on {', '.join(config.tasks)}: {len(cells)} cells."
    )
    began = perf_counter()
    measured = run_grid(
        measure_cell, cells, jobs=config.jobs, backend=config.backend, label=_label, bars=config.bars
    )
    results = sorted(measured, key=lambda result: _place(config, result.cell))
    took_s = perf_counter() - began
    console.print("2/2  Drawing, testing the hypotheses, writing the page.")
    found = figures(results)
    rows = rows_of(found)
    _write(config, results, found, rows, took_s)
    return rows


def _cells(config: SharedAutonomyConfig) -> list[Cell]:
    """The study proper, its longest cells first, and the ablations."""
    preset = config.preset
    proper = [
        Cell(
            task=task,
            model=model,
            entropy=entropy,
            variant=None,
            methods=(WITHOUT_HELP, WITH_HELP) if entropy is None else (WITH_ENTROPY,),
            people=preset.people,
            seeds=preset.seeds,
            drives=preset.drives,
            preset=preset,
            seed=config.seed,
        )
        for model in reversed(MODELS)
        for entropy in (None, Entropy(preset.entropy_weights[model]))
        for task in config.tasks
    ]
    return [*proper, *(cell for task in config.tasks for cell in _varied(config, task))]


def _varied(config: SharedAutonomyConfig, task: str) -> list[Cell]:
    """The ablation of one arm."""
    preset, ablation = config.preset, config.preset.ablation
    if ablation is None:
        return []
    return [
        Cell(
            task=task,
            model=MODEL,
            entropy=entropy,
            variant=name,
            methods=(WITH_HELP,) if entropy is None else (WITH_ENTROPY,),
            people=preset.varied_people,
            seeds=ablation.seeds,
            drives=ablation.drives,
            preset=preset,
            seed=config.seed,
        )
        for name, entropy in variants(ablation, preset.entropy_weights[MODEL]).items()
    ]


def _place(config: SharedAutonomyConfig, cell: Cell) -> tuple[int, int, bool, bool]:
    """Where a cell stands in tables: by arm, model, the study before its ablations, without entropy first."""
    return (
        config.tasks.index(cell.task),
        MODELS.index(cell.model),
        cell.variant is not None,
        cell.variant is None and cell.entropy is not None,
    )


def _label(cell: Cell) -> str:
    trained = "with entropy" if cell.entropy else "without entropy"
    return f"{cell.task}, {cell.model}, {cell.variant or trained}"


def _write(
    config: SharedAutonomyConfig,
    results: Sequence[CellResult],
    found: Sequence[Figure],
    rows: Sequence[Row],
    took_s: float,
) -> None:
    out, preset = config.out, config.preset
    tests = compare_methods(results, preset)
    draw_figures(results, found, preset, config.tasks, out)
    write_page(out, results, found, tests, preset, config.tasks, config.seed)
    write_json(out / "hypotheses.json", [test.as_json() for test in tests])
    write_json(out / "seeds.json", [_by_seed(figure) for figure in found])
    write_json(out / "courses.json", _courses(results, preset))
    write_json(
        out / "timings.json",
        {
            "backend": config.backend,
            "jobs": config.jobs,
            "grid_s": took_s,
            "cells": [
                {"cell": _label(result.cell), "fit_s": result.fit_s, "drive_s": result.drive_s}
                for result in results
            ],
        },
    )
    write_results(out / "results.json", rows, _about(config))


def _by_seed(figure: Figure) -> dict[str, object]:
    """Means of each seed's drives, and the interval that tables and figures show."""
    over = figure.interval
    return {
        "task": figure.task,
        "model": figure.model,
        "condition": figure.condition,
        "measure": figure.measure,
        "values": figure.values.mean(axis=1).tolist(),
        "mean": over.mean,
        "half_width_95": over.half_width,
        "over": over.over,
    }


def _courses(results: Sequence[CellResult], preset: Preset) -> list[dict[str, object]]:
    """What the figures show over time: state error and belief of the paper's model, mean and interval."""
    shown = {person.label for person in preset.drawn_people}
    return [
        {
            "task": result.cell.task,
            "method": outcome.method,
            "person": outcome.person.label,
            **{
                f"{what}_{part}": values.round(5).tolist()
                for what, course in (("error", outcome.error), ("belief", outcome.belief))
                for part, values in zip(("mean", "low_95", "high_95"), band(course), strict=True)
            },
        }
        for result in results
        if result.cell.model == MODEL and result.cell.variant is None
        for outcome in result.outcomes
        if outcome.person.label in shown
    ]


def _about(config: SharedAutonomyConfig) -> dict[str, object]:
    """What the figures depend on."""
    return {
        "study": STUDY,
        "preset": asdict(config.preset),
        "tasks": list(config.tasks),
        "seed": config.seed,
        "arms": "simulated",
        "people": "simulated",
    }
