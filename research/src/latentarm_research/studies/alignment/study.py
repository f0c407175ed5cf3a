"""`latentarm reproduce alignment`: learning what simulated people mean by their stick (section 8.3)."""

from collections.abc import Sequence
from math import exp
from typing import TYPE_CHECKING, Final

from latentarm.alignment import posterior, queries, tool_space
from latentarm.alignment.demonstrated import DURATION_S
from latentarm.alignment.poses import ROTATION_WEIGHT_M
from latentarm.evaluation.looks import look_of
from latentarm_research.alignment.priors import Priors
from latentarm_research.studies.alignment import curves, tables
from latentarm_research.studies.alignment import preset as conditions
from latentarm_research.studies.alignment.cell import AlignmentErrors, measure_cell
from latentarm_research.studies.alignment.curves import CurveResult, measure_curve
from latentarm_research.studies.alignment.figures import conditions_figure, curves_figure
from latentarm_research.studies.alignment.hypotheses import (
    HYPOTHESES,
    NEAR,
    compare_conditions,
)
from latentarm_research.studies.alignment.preset import PRESETS, Preset
from latentarm_research.studies.alignment.rows import STUDY as NAME
from latentarm_research.studies.alignment.rows import (
    AlignmentResults,
    series_of,
    time_alignment,
    timings,
)
from latentarm_research.studies.alignment.scene import (
    AlignmentCell,
    DecoderCell,
    LearnedDecoder,
    learn_decoder,
)
from latentarm_research.studies.claim_tables import judged_parts, verdict_tables
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.page import render_page
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.tasks.pouring.tasks import AT_BOWL_M, BOWL_M, POURING_TASKS
from latentarm_research.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, TURN_RAD_S

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MEASURES: Final = {"conditions": measure_cell, "curve": measure_curve}


def _measure(request: Request[Preset], grid: Grid) -> AlignmentResults:
    wanted = [DecoderCell(task, request.preset, request.seed) for task in request.tasks]
    decoders = grid.run("Decoders", learn_decoder, wanted, lambda cell: f"{cell.task}, decoder")
    cells = _cells(request, decoders)
    found = grid.run("Alignments and learning curves", measure, cells, _label)
    return AlignmentResults(
        decoders,
        results=sorted((one for one in found if isinstance(one, AlignmentErrors)), key=_place),
        curves=[one for one in found if isinstance(one, CurveResult)],
    )


def measure(cell: AlignmentCell) -> AlignmentErrors | CurveResult:
    """Measure one cell of the second grid."""
    return MEASURES[cell.kind](cell)


def _cells(request: Request[Preset], decoders: Sequence[LearnedDecoder]) -> list[AlignmentCell]:
    """The second grid, its longest cells first."""
    preset = request.preset
    return [
        *(AlignmentCell("curve", one, noise) for noise in preset.curves.noises for one in decoders),
        *(AlignmentCell("conditions", one, noise) for one in decoders for noise in preset.noises),
    ]


def _place(result: AlignmentErrors) -> tuple[int, float]:
    """Where a cell stands in tables."""
    return [*POURING_TASKS].index(result.cell.task), result.cell.noise


def _label(cell: AlignmentCell) -> str:
    return f"{cell.task}, noise {cell.noise:g}, {cell.kind}"


def _report(request: Request[Preset], measured: AlignmentResults) -> Report:
    series = series_of(measured)
    tests = compare_conditions(measured.results)
    figures = _figures(measured)
    # While nothing else runs.
    alone = [time_alignment(one) for one in measured.decoders]
    return Report(
        rows=[one.row(NAME) for one in series],
        page=_page(request, measured, tests, figures),
        figures=figures,
        tests=tests,
        documents={"runs.json": [one.as_json() for one in series]},
        timings={"one_alignment": alone, **timings(measured)},
        tables=verdict_tables(request.preset.name, HYPOTHESES, tests),
    )


def _figures(measured: AlignmentResults) -> "dict[str, Figure]":
    results = measured.results
    tasks = list(dict.fromkeys(result.cell.task for result in results))
    noises = list(dict.fromkeys(result.cell.noise for result in results))
    return {
        "conditions": conditions_figure(results, tasks, noises),
        "curves": curves_figure(measured.curves, tasks),
    }


def _page(
    request: Request[Preset],
    measured: AlignmentResults,
    tests: Sequence[Tested],
    figures: "dict[str, Figure]",
) -> str:
    by_task: dict[str, list[AlignmentErrors]] = {}
    for result in measured.results:
        by_task.setdefault(result.cell.task, []).append(result)
    return render_page(
        "alignment/page.md",
        command=again(STUDY, request),
        preset=request.preset,
        tasks=list(by_task),
        paper_model=conditions.PAPER_MODEL,
        figures=figures,
        speed_m_s=SPEED_M_S,
        turn_rad_s=TURN_RAD_S,
        rate_hz=RATE_HZ,
        bowl_m=BOWL_M,
        at_bowl_m=AT_BOWL_M,
        duration_s=DURATION_S,
        rotation_weight_m=ROTATION_WEIGHT_M,
        priors=Priors(),
        fading=exp(-Priors().gamma),
        conditions=conditions,
        choices=curves,
        **judged_parts(HYPOTHESES, tests),
        condition_tables={task: tables.condition_table(cells) for task, cells in by_task.items()},
        settings=posterior,
        queries=queries,
        tool_space=tool_space,
        stopping_table=tables.stopping_table(measured.curves),
        curve_tables={_curve_name(curve): tables.curve_table(curve) for curve in measured.curves},
        near=NEAR,
    )


def _curve_name(curve: CurveResult) -> str:
    cell = curve.cell
    return f"{look_of(cell.task).label}, noise {cell.noise:g}"


STUDY: Final = Study(
    name=NAME,
    command="reproduce alignment",
    presets=PRESETS,
    tasks=tuple(POURING_TASKS),
    simulated=("arms", "people"),
    measure=_measure,
    report=_report,
    figures=("conditions", "curves"),
    documents=("runs.json",),
)
