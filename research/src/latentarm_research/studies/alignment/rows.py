"""Everything that the study measured, as its rows, the figures of every run, and how long it took."""

import timeit
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Final

from threadpoolctl import threadpool_limits

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CurveResult
from latentarm_research.studies.alignment.drives import DrivesResult
from latentarm_research.studies.alignment.preset import ALL_PRIORS, CHOSEN, CONDITIONS, LEARNED, Stream, under
from latentarm_research.studies.alignment.scene import LearnedDecoder, scene_of
from latentarm_research.studies.alignment.turning import TurningResult

STUDY: Final = "alignment"

ERROR: Final = "relative_alignment_error"

ANSWERS: Final = "answers"
"""How many were asked for before asking stopped."""

ENCODED: Final = "the encoder's own choice"
"""Condition of the rows that say what the encoder's own latent actions come to."""


def rows_of(
    results: Sequence[AlignmentErrors], curves: Sequence[CurveResult], turning: Sequence[TurningResult]
) -> list[Row]:
    """Mean and SD of every figure: the tables, then the curves, then people whose axes turn."""
    rows: list[Row] = []
    for task, model in dict.fromkeys((result.cell.task, result.cell.model) for result in results):
        here = [result for result in results if (result.cell.task, result.cell.model) == (task, model)]
        rows.append(summarise(Subject(STUDY, task, model, ENCODED), ERROR, [here[0].encoded]))
        rows += [
            summarise(Subject(STUDY, task, model, under(name, result.cell.noise)), ERROR, result.errors[name])
            for result in here
            for name in CONDITIONS
        ]
    for curve in curves:
        cell = curve.cell.learned.cell
        rows += [
            summarise(Subject(STUDY, cell.task, cell.model, condition), measure, values)
            for condition, measure, values in curve_figures(curve)
        ]
    for result in turning:
        cell = result.cell.learned.cell
        rows += [
            summarise(
                Subject(STUDY, cell.task, cell.model, of_turning(name, result.cell.noise)), ERROR, values
            )
            for name, values in result.errors.items()
        ]
    return rows


def of_turning(condition: str, noise: float) -> str:
    """How rows name a condition with people whose axes turn."""
    return under(f"axes turn, {condition}", noise)


def curve_figures(curve: CurveResult) -> Iterator[tuple[str, str, FloatArray]]:
    """Condition, measure and figures (R,) of every point of a curve, and of where asking stops."""
    noise = curve.cell.noise
    for choice, errors in curve.errors.items():
        for count, values in errors.items():
            yield under(asked(choice, count), noise), ERROR, values
    stopped = under(f"{CHOSEN}, stopped", noise)
    yield stopped, ANSWERS, curve.stopped_after
    yield stopped, ERROR, curve.stopped_at


CALLS: Final = 200
"""Calls of an alignment that are timed; the fastest counts."""


def asked(choice: str, count: int) -> str:
    """How rows name a point of a curve."""
    return f"{choice}, {count} answer{'s' * (count != 1)}"


@dataclass(frozen=True, eq=False)
class AlignmentResults:
    """All results, in the order of the tables."""

    decoders: Sequence[LearnedDecoder]  # that the alignments stand on
    results: Sequence[AlignmentErrors]  # the cells of the table, by task, model and noise
    curves: Sequence[CurveResult]  # by noise, model and task
    turning: Sequence[TurningResult]  # people whose axes turn, by noise
    drives: Sequence[DrivesResult]  # one for each kind of model that was driven with


def by_run(measured: AlignmentResults) -> list[dict[str, object]]:
    """The figures of every run that rows are means of."""
    table = [
        (result.cell.task, result.cell.model, name, result.cell.noise, ERROR, values)
        for result in measured.results
        for name, values in result.errors.items()
    ]
    curves = [
        (curve.cell.learned.cell.task, curve.cell.learned.cell.model, name, curve.cell.noise, measure, values)
        for curve in measured.curves
        for name, measure, values in curve_figures(curve)
    ]
    turning = [
        (
            result.cell.learned.cell.task,
            result.cell.learned.cell.model,
            of_turning(name, result.cell.noise),
            result.cell.noise,
            ERROR,
            values,
        )
        for result in measured.turning
        for name, values in result.errors.items()
    ]
    return [
        {
            "task": task,
            "model": model,
            "condition": name,
            "noise": noise,
            "measure": measure,
            "values": values.tolist(),
        }
        for task, model, name, noise, measure, values in (*table, *curves, *turning)
    ]


def timings(measured: AlignmentResults) -> dict[str, object]:
    """How long everything took, s; cells ran side by side."""
    return {
        "decoders": [
            {"task": one.cell.task, "model": one.cell.model, "fit_s": one.fit_s} for one in measured.decoders
        ],
        "alignments": [
            {
                "task": result.cell.task,
                "model": result.cell.model,
                "noise": result.cell.noise,
                "learn_s": dict(result.learn_s),
            }
            for result in measured.results
        ],
        "drives": [
            {
                "model": one.cell.model,
                "fit_s": one.fit_s,
                "align_s": one.align_s,
                "drive_s": one.drive_s,
            }
            for one in measured.drives
        ],
    }


def time_alignment(learned: LearnedDecoder) -> dict[str, object]:
    """How long one alignment takes to learn, with priors and in tool space, and to call, s; one thread."""
    preset, scene = learned.cell.preset, scene_of(learned)
    answers = [scene.ask(preset.answers, 0.0, Stream.QUESTIONS, Stream.ANSWERS, 0)]
    config = FitConfig(LEARNED[ALL_PRIORS], steps=preset.steps)
    with threadpool_limits(limits=1):
        began = perf_counter()
        scene.learn(answers[:1], config, [0])
        priors_s, began = perf_counter() - began, perf_counter()
        alignment = scene.in_tool_space(answers[0])
        tool_space_s = perf_counter() - began
        u, context = scene.test.u[0], scene.test.motions.context[0]
        calls = timeit.repeat(lambda: alignment(u, context), number=1, repeat=CALLS)
    return {
        "task": learned.cell.task,
        "model": learned.cell.model,
        "answers": preset.answers,
        "steps": preset.steps,
        "all_priors_s": priors_s,
        "tool_space_s": tool_space_s,
        "tool_space_call_s": min(calls),
    }
