"""Figure: how the error falls with the number of answers, by how questions are chosen."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.metrics.looks import look_of
from latentarm.studies.alignment.curves import AT_RANDOM, BY_NOVELTY, CHOICES, CurveResult
from latentarm.studies.alignment.targets import RANDOM_ANSWERS
from latentarm.studies.drawing import plain_ticks, title
from latentarm.studies.statistics import reach_of_interval
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_MM: Final = 46.0
FRAME_MM: Final = 18.0
NUDGE: Final = 0.16
"""How far choices stand from each other, in answers, so that no bar hides another."""


def curves_figure(curves: Sequence[CurveResult], tasks: Sequence[str]) -> "Figure":
    """Means with 95 % intervals over the number of answers, a panel per task, a row per model and noise.

    Args:
        curves: every curve.
        tasks: from left to right.
    """
    places = list(dict.fromkeys((curve.cell.learned.cell.model, curve.cell.noise) for curve in curves))
    figure = new_figure(ROW_MM * len(places) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "Relative alignment error, all priors, mean over runs with 95 % interval; people and arm simulated",
        fontsize=FONT_SIZE,
    )
    panels = figure.subplots(len(places), len(tasks), sharex=True, squeeze=False)
    known = {
        (curve.cell.learned.cell.model, curve.cell.noise, curve.cell.learned.cell.task): curve
        for curve in curves
    }
    for line, (model, noise) in zip(panels, places, strict=True):
        for axes, task in zip(line, tasks, strict=True):
            _draw(axes, known[model, noise, task])
            title(axes, f"{look_of(task).label}, {look_of(model).label}, noise {noise:g}")
        line[0].set_ylabel("relative error", fontsize=FONT_SIZE)
    for axes in panels[-1]:
        axes.set_xlabel("answers", fontsize=FONT_SIZE)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, handles, labels, handle_length=2.6)
    return figure


def _draw(axes: "Axes", curve: CurveResult) -> None:
    for index, choice in enumerate(CHOICES):
        errors = curve.errors[choice]
        means = [float(values.mean()) for values in errors.values()]
        look = look_of(choice)
        axes.errorbar(
            [count + (index - 1) * NUDGE for count in errors],
            means,
            yerr=np.transpose([reach_of_interval(values) for values in errors.values()]),
            color=look.colour,
            marker=look.marker,
            linestyle=look.dash,
            markersize=3.2,
            linewidth=1.0,
            elinewidth=0.6,
            label=look.label,
            zorder=3 + index,
        )
    if RANDOM_ANSWERS in curve.errors[AT_RANDOM]:
        axes.axhline(
            curve.errors[AT_RANDOM][RANDOM_ANSWERS].mean(),
            color="black",
            linestyle=":",
            linewidth=0.8,
            label=f"{RANDOM_ANSWERS} answers at random",
            zorder=2,
        )
    axes.plot(
        curve.stopped_after.mean(),
        curve.stopped_at.mean(),
        marker="*",
        markersize=8.0,
        color="white",
        markeredgecolor=look_of(BY_NOVELTY).colour,
        linestyle="none",
        label="where asking stops (mean)",
        zorder=8,
    )
    axes.set_yscale("log")
    plain_ticks(axes)
    axes.set_xlim(left=0.0)
    tidy(axes)
