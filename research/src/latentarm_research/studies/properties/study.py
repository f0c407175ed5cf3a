"""`latentarm reproduce properties`: every model on every task (section 8.1)."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Final

from latentarm.core.types import Row
from latentarm_research.studies.claim_tables import judged_parts
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.page import render_page
from latentarm_research.studies.properties import tables
from latentarm_research.studies.properties.cell import (
    PropertiesCell,
    PropertiesResult,
    condition,
    measure_cell,
)
from latentarm_research.studies.properties.cells import cells_table, count, paper_cells, sweep_table
from latentarm_research.studies.properties.figures import (
    beside_paper_figure,
    controllability_figure,
    noise_figure,
)
from latentarm_research.studies.properties.hypotheses import HYPOTHESES, LINEAR, MARK, compare_models
from latentarm_research.studies.properties.motion_figures.catalogue import TASK_FIGURES
from latentarm_research.studies.properties.paper import with_paper
from latentarm_research.studies.properties.preset import AS_CHOSEN, PRESETS, Preset, designs
from latentarm_research.studies.series import Series
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.tasks.planar.catalogue import MOTIONS
from latentarm_research.tasks.planar.paths import STEP_S

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _measure(request: Request[Preset], grid: Grid) -> list[PropertiesResult]:
    # Without noise most is measured: these take longest, and begin first. The models of a task stand
    # together, so that one process demonstrates once for all of them.
    cells = [
        PropertiesCell(task, model, noise_rad, preset, request.seed, design)
        for (design, preset), noise_rad in product(designs(request.preset).items(), request.preset.noises_rad)
        for task, model in product(request.tasks, request.preset.models)
    ]
    return grid.run("Models on tasks", measure_cell, cells, _label)


def _label(cell: PropertiesCell) -> str:
    design = [cell.design] if cell.design != AS_CHOSEN else []
    return ", ".join([cell.task, cell.model, condition(cell.noise_rad), *design])


def _report(request: Request[Preset], results: list[PropertiesResult]) -> Report:
    proper = [result for result in results if result.cell.design == AS_CHOSEN]
    rows = with_paper([row for task in request.tasks for row in _rows(proper, task)])
    tests = compare_models(proper)
    figures = _figures(proper, rows, request.tasks)
    swept = _swept(request, results)
    cells = [
        {
            "task": cell.task,
            "model": cell.model,
            "condition": condition(cell.noise_rad),
            "design": cell.design,
        }
        for cell in (result.cell for result in results)
    ]
    return Report(
        rows=rows + swept,
        page=_page(request, rows, swept, tests, figures),
        figures=figures,
        tests=tests,
        documents={
            "seeds.json": [
                {**one.as_json(), **cell}
                for cell, result in zip(cells, results, strict=True)
                for one in _series(result)
            ]
        },
        timings={"cells": [{**cell, "fit_s": one.fit_s} for cell, one in zip(cells, results, strict=True)]},
    )


def _series(result: PropertiesResult, under: str | None = None) -> list[Series]:
    """The figures of a cell, under the condition by which rows name it."""
    cell = result.cell
    return [Series(cell.task, cell.model, under, *figures) for figures in result.figures.items()]


def _swept(request: Request[Preset], results: Sequence[PropertiesResult]) -> list[Row]:
    """Rows of every design, with its name as their condition; none where there is one design."""
    names = designs(request.preset)
    if len(names) < 2:
        return []
    found: list[Row] = []
    for name in names:
        own = [one for one in results if one.cell.design == name]
        rows = with_paper([row for task in request.tasks for row in _rows(own, task)])
        found += [replace(row, condition=name) for row in rows if row.condition is None]
    return found


def _rows(results: Sequence[PropertiesResult], task: str) -> list[Row]:
    """One task's rows: without noise everything, and in the sweep what is measured under every noise."""
    here = [result for result in results if result.cell.task == task]
    series = [one for result in here if result.cell.noise_rad == 0 for one in _series(result)]
    if len({result.cell.noise_rad for result in here}) > 1:
        swept = set[str].intersection(*(set(result.figures) for result in here))
        noisy = [one for result in here for one in _series(result, condition(result.cell.noise_rad))]
        series += [one for one in noisy if one.measure in swept]
    return [one.row(STUDY.name) for one in series]


def _figures(
    results: Sequence[PropertiesResult], rows: Sequence[Row], tasks: Sequence[str]
) -> "dict[str, Figure]":
    """Those over all tasks, and one for each task."""
    noises_rad = sorted({result.cell.noise_rad for result in results})
    figures = {
        "beside_paper": beside_paper_figure(rows, tasks),
        "controllability": controllability_figure(rows, tasks),
    }
    if len(noises_rad) > 1:
        figures["noise"] = noise_figure(rows, tasks, noises_rad)
    for task in tasks:
        here = [one for one in results if (one.cell.task, one.cell.noise_rad) == (task, 0.0)]
        figures[task] = TASK_FIGURES[task]({one.cell.model: one.decoder for one in here}, rows)
    return figures


def _page(
    request: Request[Preset],
    rows: Sequence[Row],
    swept: Sequence[Row],
    tests: Sequence[Tested],
    figures: "dict[str, Figure]",
) -> str:
    as_good = {task: tables.as_good_as_paper(rows, task) for task in request.tasks}
    cells = paper_cells(rows)
    return render_page(
        "properties/page.md",
        command=again(STUDY, request),
        preset=request.preset,
        tasks=request.tasks,
        step_s=STEP_S,
        cells_found=count(cells),
        cells_found_by_means=count(paper_cells(rows, means=True)),
        cells_table=cells_table(cells),
        sweep_table=sweep_table(swept, list(designs(request.preset))) if swept else "",
        **judged_parts(HYPOTHESES, tests),
        ours=tables.OURS,
        as_good={task: counts for task, counts in as_good.items() if counts[1]},
        figures=list(figures),
        paper_tables={task: tables.paper_table(rows, task) for task in request.tasks},
        noise_tables={task: tables.noise_table(rows, task) for task in request.tasks if "noise" in figures},
        unit_not_stated=tables.UNIT_NOT_STATED,
        compared_measures=", ".join(
            claim.measure for one in HYPOTHESES for claim in one.claims if claim.against != MARK
        ),
        linear=LINEAR,
    )


STUDY: Final = Study(
    name="properties",
    command="reproduce properties",
    presets=PRESETS,
    tasks=tuple(MOTIONS),
    simulated=("arms",),
    measure=_measure,
    report=_report,
    figures=("beside_paper", "controllability", "noise", *TASK_FIGURES),
    documents=("seeds.json",),
)
