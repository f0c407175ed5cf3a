"""`latentarm reproduce shared-autonomy`: simulated people with help and without (section 8.2)."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from latentarm_research.studies.claim_tables import judged_parts, verdict_tables
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.page import render_page
from latentarm_research.studies.shared_autonomy import choice, drive, hypotheses
from latentarm_research.studies.shared_autonomy import preset as people
from latentarm_research.studies.shared_autonomy.cell import (
    TASKS,
    WITHOUT_HELP,
    AutonomyCell,
    AutonomyResult,
    measure_cell,
)
from latentarm_research.studies.shared_autonomy.figures import (
    changes_figure,
    expertise_figure,
    learners_figure,
    slopes_figure,
    task_figure,
)
from latentarm_research.studies.shared_autonomy.measures import ARRIVED, EVERY
from latentarm_research.studies.shared_autonomy.preset import PRESETS, Preset
from latentarm_research.studies.shared_autonomy.tables import (
    FEWEST_SEEDS,
    MODEL,
    Figure,
    Tables,
    figures,
    rows_of,
)
from latentarm_research.studies.shared_autonomy.tables import STUDY as NAME
from latentarm_research.studies.study import Grid, Report, Request, Study, again

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

MODELS: Final = (MODEL, "cvae")  # the paper's model, and that of its equation 16 in full

MAIN: Final = (hypotheses.MEASURE, "time_s")
"""Measures that are shown of the paper's model at once; the others are to be unfolded."""


def cells_of(request: Request[Preset]) -> list[AutonomyCell]:
    """Every model on every arm, the longest cells first."""
    return [
        AutonomyCell(task, model, entropy, request.preset, request.seed)
        for model in reversed(MODELS)
        for entropy in (False, True)
        for task in request.tasks
    ]


def _measure(request: Request[Preset], grid: Grid) -> list[AutonomyResult]:
    measured = grid.run("Models, with entropy and without", measure_cell, cells_of(request), _label)

    def place(result: AutonomyResult) -> tuple[int, int, bool]:
        """By arm, model, without entropy first."""
        cell = result.cell
        return request.tasks.index(cell.task), MODELS.index(cell.model), cell.entropy

    return sorted(measured, key=place)


def _label(cell: AutonomyCell) -> str:
    return f"{cell.task}, {cell.model}, {'with' if cell.entropy else 'without'} entropy"


def _report(request: Request[Preset], results: list[AutonomyResult]) -> Report:
    found = figures(results)
    rows, tests = rows_of(found), hypotheses.compare_methods(results, request.preset)
    drawings = _drawings(request, results)
    return Report(
        rows=rows,
        page=_page(request, found, tests, drawings),
        figures=drawings,
        tests=tests,
        documents={
            "seeds.json": [_by_seed(figure) for figure in found],
        },
        tables=verdict_tables(request.preset.name, hypotheses.HYPOTHESES, tests),
    )


def _drawings(request: Request[Preset], results: Sequence[AutonomyResult]) -> "dict[str, Drawing]":
    preset, tasks = request.preset, request.tasks
    drawings = {"panda_two_cups": task_figure()} if "panda_two_cups" in tasks else {}
    return drawings | {
        "fixed_expertise": expertise_figure(results, preset, tasks),
        "change_of_mind": changes_figure(results, preset, tasks),
        "learners": learners_figure(results, preset, tasks),
        "learner_slopes": slopes_figure(results, preset, tasks),
    }


def _page(
    request: Request[Preset],
    found: Sequence[Figure],
    tests: Sequence[Tested],
    drawings: "dict[str, Drawing]",
) -> str:
    preset = request.preset
    measures = dict.fromkeys(one.measure for one in found if one.condition.startswith(f"{WITHOUT_HELP}, "))
    return render_page(
        "shared_autonomy/page.md",
        command=again(STUDY, request),
        preset=preset,
        tasks=request.tasks,
        model=MODEL,
        models=MODELS,
        drive=drive,
        people=people,
        **judged_parts(hypotheses.HYPOTHESES, tests),
        figures=sorted(drawings),
        tables=Tables(found, preset),
        main=MAIN,
        others=[measure for measure in measures if measure not in MAIN],
        measures=list(measures),
        few_seeds=preset.seeds < FEWEST_SEEDS,
        arrived=ARRIVED,
        reached=hypotheses.REACHED,
        trapped=hypotheses.TRAPPED,
        choice=choice,
        every=EVERY,
        belief=drive.RULE.keywords,
    )


def _by_seed(figure: Figure) -> dict[str, Any]:
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


STUDY: Final = Study(
    name=NAME,
    command="reproduce shared-autonomy",
    presets=PRESETS,
    tasks=tuple(TASKS),
    simulated=("arms", "people"),
    measure=_measure,
    report=_report,
    figures=(
        "fixed_expertise",
        "change_of_mind",
        "learners",
        "learner_slopes",
        "panda_two_cups",
    ),
    documents=("seeds.json",),
)
