"""`latentarm reproduce alignment`: learning what simulated people mean by their stick (section 8.3)."""

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
from latentarm_research.studies.alignment.figures import conditions_figure
from latentarm_research.studies.alignment.hypotheses import (
    HYPOTHESES,
    NEAR,
    compare_conditions,
)
from latentarm_research.studies.alignment.preset import PRESETS, Preset
from latentarm_research.studies.alignment.scene import (
    AlignmentCell,
    DecoderCell,
    learn_decoder,
)
from latentarm_research.studies.claim_tables import judged_parts, verdict_tables
from latentarm_research.studies.page import render_page
from latentarm_research.studies.study import Grid, Report, Request, Study, again
from latentarm_research.tasks.pouring.tasks import AT_BOWL_M, BOWL_M, POURING_TASKS
from latentarm_research.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, TURN_RAD_S


def _measure(request: Request[Preset], grid: Grid) -> list[AlignmentErrors]:
    wanted = [DecoderCell(task, request.preset, request.seed) for task in request.tasks]
    models = grid.run("Decoders", learn_decoder, wanted, lambda cell: f"{cell.task}, decoder")
    cells = [
        AlignmentCell(decoder, model, noise)
        for decoder, model in zip(wanted, models, strict=True)
        for noise in request.preset.noises
    ]
    return grid.run("Alignments", measure_cell, cells, lambda cell: f"{cell.task}, noise {cell.noise:g}")


def _report(request: Request[Preset], results: list[AlignmentErrors]) -> Report:
    series = tables.series_of(results)
    tests = compare_conditions(results)
    by_task = {task: [one for one in results if one.cell.task == task] for task in request.tasks}
    page = render_page(
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
        curve_tables={
            f"{look_of(one.cell.task).label}, noise {one.cell.noise:g}": tables.curve_table(one)
            for one in tables.with_curves(results)
        },
        near=NEAR,
    )
    return Report(
        rows=[one.row(STUDY.name) for one in series],
        page=page,
        figures={"conditions": conditions_figure(results, request.tasks, request.preset.noises)},
        tests=tests,
        documents={"runs.json": [one.as_json() for one in series]},
        tables=verdict_tables(request.preset.name, HYPOTHESES, tests),
    )


STUDY: Final = Study(
    name="alignment",
    command="reproduce alignment",
    presets=PRESETS,
    tasks=tuple(POURING_TASKS),
    simulated=("arms", "people"),
    measure=_measure,
    report=_report,
    figures=("conditions",),
    documents=("runs.json",),
)
