"""`latentarm reproduce properties`: every model on every task (section 8.1), as a page with figures."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Final

from latentarm.metrics.results import write_results
from latentarm.metrics.summary import Subject, summarise
from latentarm.models.catalogue import MODELS
from latentarm.parallel.grid import check_processes, run_grid
from latentarm.runs.checks import check_seed
from latentarm.runs.results_folder import Study, write_json
from latentarm.studies.properties.cell import Cell, CellResult, measure_cell
from latentarm.studies.properties.figures.draw import FIGURES, draw_figures
from latentarm.studies.properties.figures.noise import condition
from latentarm.studies.properties.hypotheses import compare_models
from latentarm.studies.properties.page import write_page
from latentarm.studies.properties.paper import with_paper
from latentarm.studies.properties.preset import Preset
from latentarm.studies.tasks import check_tasks
from latentarm.tasks.planar.catalogue import MOTIONS
from latentarm.types import Row
from latentarm.untrusted.console import VisibleConsole

STUDY: Final = "properties"

MADE: Final = (
    "results.json",
    "results.md",
    "seeds.json",
    "hypotheses.json",
    "timings.json",
    *(f"{name}.png" for name in FIGURES),
)
"""Every file of the folder, beside what was asked for."""


@dataclass(frozen=True)
class PropertiesConfig:
    """What `latentarm reproduce properties` was asked for.

    Attributes:
        out: a new folder, or that of an earlier run of this study, which is replaced.
        preset: sizes of the study.
        tasks: names in `MOTIONS`.
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
    tasks: tuple[str, ...] = tuple(MOTIONS)
    seed: int = 0
    jobs: int = -1
    backend: str = "joblib"
    quiet: bool = False
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, self.backend)
        check_tasks(self.tasks, MOTIONS)


def run_properties(config: PropertiesConfig) -> list[Row]:
    """Measure every cell of the study and write figures, tables and tests to ``config.out``.

    ``results.json`` depends on preset, tasks and seed alone; how long it took stands in ``timings.json``.

    Returns:
        Per task the figures without noise, with the paper's beside them, and those of the noise sweep, whose
        condition is ``noise ... rad``.

    Raises:
        UserError: the folder holds something else or cannot be written, the backend is not to be had, or a
            cell cannot be measured as asked; then it says which.
    """
    Study(STUDY, MADE).claim(config.out, _about(config))
    console = VisibleConsole(stderr=True, quiet=config.quiet)
    cells = _cells(config)
    console.print(
        f"1/2  {len(MODELS)} models on {', '.join(config.tasks)} at {len(config.preset.noises_rad)} levels of"
        f" noise: {len(cells)} cells, {config.preset.seeds} seeds each."
    )
    began = perf_counter()
    results = run_grid(
        measure_cell, cells, jobs=config.jobs, backend=config.backend, label=_label, bars=config.bars
    )
    took_s = perf_counter() - began
    console.print("2/2  Drawing, testing the hypotheses, writing the page.")
    rows = with_paper([row for task in config.tasks for row in _rows(results, task)])
    _write(config, results, rows, took_s)
    return rows


def _cells(config: PropertiesConfig) -> list[Cell]:
    # Without noise most is measured: these take longest, and begin first.
    return [
        Cell(task=task, model=model, noise_rad=noise_rad, preset=config.preset, seed=config.seed)
        for noise_rad, task, model in product(config.preset.noises_rad, config.tasks, MODELS)
    ]


def _label(cell: Cell) -> str:
    return f"{cell.task}, {cell.model}, {condition(cell.noise_rad)}"


def _rows(results: Sequence[CellResult], task: str) -> list[Row]:
    """One task's rows: without noise everything, and in the sweep what is measured under every noise."""
    here = [result for result in results if result.cell.task == task]
    rows = [
        summarise(Subject(STUDY, task, result.cell.model), measure, values)
        for result in here
        if result.cell.noise_rad == 0
        for measure, values in result.figures.items()
    ]
    if len({result.cell.noise_rad for result in here}) < 2:
        return rows
    swept = set[str].intersection(*(set(result.figures) for result in here))
    rows += [
        summarise(Subject(STUDY, task, result.cell.model, condition(result.cell.noise_rad)), measure, values)
        for result in here
        for measure, values in result.figures.items()
        if measure in swept
    ]
    return rows


def _write(
    config: PropertiesConfig, results: Sequence[CellResult], rows: Sequence[Row], took_s: float
) -> None:
    out = config.out
    tests = compare_models(results)
    draw_figures(results, rows, out)
    write_page(out, results, rows, tests, config.preset, config.tasks, config.seed)
    write_json(out / "hypotheses.json", [test.as_json() for test in tests])
    write_json(
        out / "seeds.json",
        [
            {
                **_place(result.cell),
                "measure": measure,
                "values": [x if math.isfinite(x) else None for x in values.tolist()],
            }
            for result in results
            for measure, values in result.figures.items()
        ],
    )
    write_json(
        out / "timings.json",
        {
            "backend": config.backend,
            "jobs": config.jobs,
            "grid_s": took_s,
            "cells": [{**_place(result.cell), "fit_s": result.fit_s} for result in results],
        },
    )
    write_results(out / "results.json", rows, _about(config))


def _place(cell: Cell) -> dict[str, object]:
    return {"task": cell.task, "model": cell.model, "condition": condition(cell.noise_rad)}


def _about(config: PropertiesConfig) -> dict[str, object]:
    """What the figures depend on."""
    return {
        "study": STUDY,
        "preset": asdict(config.preset),
        "tasks": list(config.tasks),
        "seed": config.seed,
        "arms": "simulated",
    }
