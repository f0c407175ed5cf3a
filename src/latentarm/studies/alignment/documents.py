"""What the study writes beside its rows: the figures of every run, and how long everything took."""

from time import perf_counter

from threadpoolctl import threadpool_limits

from latentarm.alignment.training import FitConfig
from latentarm.studies.alignment.conditions import ALL_PRIORS, LEARNED
from latentarm.studies.alignment.decoder import LearnedDecoder
from latentarm.studies.alignment.measured import Measured
from latentarm.studies.alignment.rows import ERROR, curve_figures
from latentarm.studies.alignment.scene import scene_of
from latentarm.studies.alignment.streams import Stream


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
