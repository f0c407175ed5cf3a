"""`latentarm reproduce properties`: every model on every task (section 8.1)."""

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Final

from latentarm.core.types import Row
from latentarm.core.untrusted.console import VisibleConsole
from latentarm.evaluation.table import rich_tables
from latentarm_research.studies.claim_tables import judged_parts
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.page import render_page
from latentarm_research.studies.properties.cell import (
    PropertiesCell,
    PropertiesResult,
    measure_cell,
)
from latentarm_research.studies.properties.figures import (
    beside_paper_figure,
)
from latentarm_research.studies.properties.hypotheses import HYPOTHESES, LINEAR, MARK, compare_models
from latentarm_research.studies.properties.paper import with_paper
from latentarm_research.studies.properties.preset import PRESETS, Preset
from latentarm_research.studies.properties.reach_figure import reach_figure
from latentarm_research.studies.properties.sine_figure import sine_figure
from latentarm_research.studies.properties.tables import (
    UNIT_NOT_STATED,
    cells_table,
    count,
    paper_cells,
    paper_table,
)
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.studies.tables import Series
from latentarm_research.tasks.planar.catalogue import MOTIONS
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.paths import STEP_S

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TASK_FIGURES: Final = {"sine": sine_figure, "reach": reach_figure}
"""Motions of one decoder of each model, of the first seed, on a task."""


def _measure(request: Request[Preset], grid: Grid) -> list[PropertiesResult]:
    # The models of a task stand together, so that one process demonstrates once for all of them.
    cells = [
        PropertiesCell(task, model, request.preset, request.seed)
        for task, model in product(request.tasks, request.preset.models)
    ]
    return grid.run("Models on tasks", measure_cell, cells, _label)


def _label(cell: PropertiesCell) -> str:
    return f"{cell.task}, {cell.model}"


def _report(request: Request[Preset], results: list[PropertiesResult]) -> Report:
    series = [one for result in results for one in _series(result)]
    rows = with_paper([one.row(STUDY.name) for one in series])
    tests = compare_models(results)
    figures = _figures(results, rows, request.tasks)
    return Report(
        rows=rows,
        page=_page(request, rows, tests, figures),
        figures=figures,
        tests=tests,
        documents={"seeds.json": [one.as_json() for one in series]},
        tables=[
            rich_tables(
                [row for row in rows if row.task == task],
                title=f"{task}, simulated",
                width=VisibleConsole().width,
            )
            for task in request.tasks
        ],
    )


def _series(result: PropertiesResult) -> list[Series]:
    cell = result.cell
    return [Series(cell.task, cell.model, None, *figures) for figures in result.figures.items()]


def _figures(
    results: Sequence[PropertiesResult], rows: Sequence[Row], tasks: Sequence[str]
) -> "dict[str, Figure]":
    """That over all tasks, and those of `TASK_FIGURES`."""
    figures = {"beside_paper": beside_paper_figure(rows, tasks)}
    for task in [task for task in tasks if task in TASK_FIGURES]:
        here = [one for one in results if one.cell.task == task]
        figures[task] = TASK_FIGURES[task]({one.cell.model: one.decoder for one in here}, rows)
    return figures


def _page(
    request: Request[Preset],
    rows: Sequence[Row],
    tests: Sequence[Tested],
    figures: "dict[str, Figure]",
) -> str:
    cells = paper_cells(rows)
    return render_page(
        "properties/page.md",
        command=again(STUDY, request),
        preset=request.preset,
        tasks=request.tasks,
        step_s=STEP_S,
        design=PlanarMotion,
        cells_found=count(cells),
        cells_found_by_means=count(paper_cells(rows, means=True)),
        cells_table=cells_table(cells),
        **judged_parts(HYPOTHESES, tests),
        figures=list(figures),
        paper_tables={task: paper_table(rows, task) for task in request.tasks},
        unit_not_stated=UNIT_NOT_STATED,
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
    figures=("beside_paper", *TASK_FIGURES),
    documents=("seeds.json",),
)
