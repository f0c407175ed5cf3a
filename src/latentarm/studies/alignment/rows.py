"""Everything that the study measured, as its rows, the figures of every run, and how long it took."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Final

from threadpoolctl import threadpool_limits

from latentarm.alignment.training import FitConfig
from latentarm.metrics.summary import Subject, summarise
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.curves import BY_NOVELTY, CurveResult
from latentarm.studies.alignment.drives import DrivesResult
from latentarm.studies.alignment.preset import ALL_PRIORS, CONDITIONS, LEARNED, Stream, under
from latentarm.studies.alignment.scene import LearnedDecoder, scene_of
from latentarm.types import FloatArray, Row

STUDY: Final = "alignment"

ERROR: Final = "relative_alignment_error"

ANSWERS: Final = "answers"
"""How many were asked for before asking stopped."""

ENCODED: Final = "the encoder's own choice"
"""Condition of the rows that say what the encoder's own latent actions come to."""


def rows_of(results: Sequence[CellResult], curves: Sequence[CurveResult]) -> list[Row]:
    """Mean and SD over runs of every figure; the table of each task and model first, then the curves."""
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
    return rows


def curve_figures(curve: CurveResult) -> Iterator[tuple[str, str, FloatArray]]:
    """Condition, measure and figures (R,) of every point of a curve, and of where asking stops."""
    noise = curve.cell.noise
    for choice, errors in curve.errors.items():
        for count, values in errors.items():
            yield under(asked(choice, count), noise), ERROR, values
    stopped = under(f"{BY_NOVELTY}, stopped", noise)
    yield stopped, ANSWERS, curve.stopped_after
    yield stopped, ERROR, curve.stopped_at


def asked(choice: str, count: int) -> str:
    """How rows name a point of a curve."""
    return f"{choice}, {count} answer{'s' * (count != 1)}"


@dataclass(frozen=True, eq=False)
class Measured:
    """All results, in the order of the tables.

    Attributes:
        decoders: that the alignments stand on.
        results: the cells of the table, by task, model and noise.
        curves: by noise, model and task.
        drives: one for each kind of model that was driven with.
    """

    decoders: Sequence[LearnedDecoder]
    results: Sequence[CellResult]
    curves: Sequence[CurveResult]
    drives: Sequence[DrivesResult]


def by_run(measured: Measured) -> list[dict[str, object]]:
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
    return [
        {
            "task": task,
            "model": model,
            "condition": name,
            "noise": noise,
            "measure": measure,
            "values": values.tolist(),
        }
        for task, model, name, noise, measure, values in (*table, *curves)
    ]


def timings(measured: Measured) -> dict[str, object]:
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
    """How long one alignment with all priors takes, alone and with all runs in one fit, s; on one thread."""
    preset, scene = learned.cell.preset, scene_of(learned)
    answers = [
        scene.ask(preset.answers, 0.0, Stream.QUESTIONS, Stream.ANSWERS, run) for run in range(preset.runs)
    ]
    config = FitConfig(LEARNED[ALL_PRIORS], steps=preset.steps)
    took_s: list[float] = []
    for runs in (range(1), range(preset.runs)):
        began = perf_counter()
        with threadpool_limits(limits=1):
            scene.learn([answers[run] for run in runs], config, runs)
        took_s.append(perf_counter() - began)
    return {
        "task": learned.cell.task,
        "model": learned.cell.model,
        "answers": preset.answers,
        "steps": preset.steps,
        "alone_s": took_s[0],
        "runs": preset.runs,
        "in_one_fit_s": took_s[1],
    }
