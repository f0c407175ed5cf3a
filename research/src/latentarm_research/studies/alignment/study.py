"""`latentarm reproduce alignment`: learning what simulated people mean by their stick (section 8.3)."""

from collections.abc import Sequence
from math import exp
from typing import Final

from latentarm.alignment import posterior, queries, tool_space
from latentarm.alignment.demonstrated import DURATION_S
from latentarm.alignment.poses import ROTATION_WEIGHT_M
from latentarm.evaluation.looks import look_of
from latentarm_research.alignment.priors import Priors
from latentarm_research.studies.alignment import preset as conditions
from latentarm_research.studies.alignment import tables
from latentarm_research.studies.alignment.cell import AlignmentErrors, measure_cell
from latentarm_research.studies.alignment.curves import CurveResult, measure_curve
from latentarm_research.studies.alignment.figures import conditions_figure
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
)
from latentarm_research.studies.alignment.scene import (
    AlignmentCell,
    DecoderCell,
    learn_decoder,
)
from latentarm_research.studies.claim_tables import judged_parts, verdict_tables
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.page import render_page
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.tasks.pouring.tasks import AT_BOWL_M, BOWL_M, POURING_TASKS
from latentarm_research.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, TURN_RAD_S


def _measure(request: Request[Preset], grid: Grid) -> AlignmentResults:
    wanted = [DecoderCell(task, request.preset, request.seed) for task in request.tasks]
    decoders = grid.run("Decoders", learn_decoder, wanted, lambda cell: f"{cell.task}, decoder")
    curves = [AlignmentCell(one, noise) for noise in request.preset.curves.noises for one in decoders]
    cells = [AlignmentCell(one, noise) for one in decoders for noise in request.preset.noises]
    return AlignmentResults(
        decoders,
        curves=grid.run("Learning curves", measure_curve, curves, _label),
        results=grid.run("Alignments", measure_cell, cells, _label),
    )


def _label(cell: AlignmentCell) -> str:
    return f"{cell.task}, noise {cell.noise:g}"


def _report(request: Request[Preset], measured: AlignmentResults) -> Report:
    series = series_of(measured)
    tests = compare_conditions(measured.results)
    figures = {"conditions": conditions_figure(measured.results, request.tasks, request.preset.noises)}
    # While nothing else runs.
    alone = [time_alignment(one) for one in measured.decoders]
    return Report(
        rows=[one.row(NAME) for one in series],
        page=_page(request, measured, tests),
        figures=figures,
        tests=tests,
        documents={"runs.json": [one.as_json() for one in series]},
        timings={"one_alignment": alone},
        tables=verdict_tables(request.preset.name, HYPOTHESES, tests),
    )


def _page(
    request: Request[Preset],
    measured: AlignmentResults,
    tests: Sequence[Tested],
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
        **judged_parts(HYPOTHESES, tests),
        condition_tables={task: tables.condition_table(cells) for task, cells in by_task.items()},
        settings=posterior,
        queries=queries,
        tool_space=tool_space,
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
    figures=("conditions",),
    documents=("runs.json",),
)
