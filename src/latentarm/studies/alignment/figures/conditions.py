"""Figure, like the paper's Figure 12: the error of every condition, by noise."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.metrics.looks import look_of
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.conditions import CONDITIONS
from latentarm.studies.alignment.rows import ENCODED
from latentarm.studies.drawing import plain_ticks, title
from latentarm.studies.statistics import bootstrap_interval, reach_of_interval
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_MM: Final = 48.0
FRAME_MM: Final = 20.0
GROUP: Final = 0.86
"""Width of a group of conditions; groups are 1 apart."""

ROOM: Final = 1.6
"""Free room below and above everything on the logarithmic axis, as a factor."""


def conditions_figure(
    results: Sequence[CellResult], models: Sequence[str], tasks: Sequence[str], noises: Sequence[float]
) -> "Figure":
    """Means with 95 % intervals, a panel per task, a row per model, grouped by noise.

    Args:
        results: every cell.
        models: those to be shown.
        tasks: from left to right.
        noises: coefficients of variation of the answers.
    """
    figure = new_figure(ROW_MM * len(models) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "Relative alignment error, mean over runs with 95 % interval; people and arm simulated",
        fontsize=FONT_SIZE,
    )
    panels = figure.subplots(len(models), len(tasks), sharex=True, sharey="row", squeeze=False)
    for line, model in zip(panels, models, strict=True):
        for axes, task in zip(line, tasks, strict=True):
            here = [result for result in results if (result.cell.model, result.cell.task) == (model, task)]
            _draw(axes, here)
            title(
                axes,
                look_of(task).label if len(models) == 1 else f"{look_of(task).label}, {look_of(model).label}",
            )
        _log_axis(line[0], [result for result in results if result.cell.model == model])
        line[0].set_ylabel("relative error", fontsize=FONT_SIZE)
    for axes in panels[-1]:
        axes.set_xticks(range(len(noises)), [f"{noise:g}" for noise in noises])
        axes.set_xlabel("coefficient of variation of answers", fontsize=FONT_SIZE)
    (line, *points), (encoded, *names) = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, [*points, line], [*names, encoded])
    return figure


def _draw(axes: "Axes", results: Sequence[CellResult]) -> None:
    """All conditions of one task and model, one group per noise, and the encoder's own choice."""
    width = GROUP / len(CONDITIONS)
    groups = np.arange(len(results))
    for index, name in enumerate(CONDITIONS):
        errors = [result.errors[name] for result in results]
        look = look_of(name)
        axes.errorbar(
            groups + (index - (len(CONDITIONS) - 1) / 2) * width,
            [values.mean() for values in errors],
            yerr=np.transpose([reach_of_interval(values) for values in errors]),
            color=look.colour,
            marker=look.marker,
            linestyle="none",
            markersize=4.2,
            elinewidth=1.0,
            label=look.label,
            zorder=2,
        )
    axes.axhline(
        results[0].encoded,
        color="black",
        linestyle=":",
        linewidth=0.9,
        label=ENCODED,
        zorder=3,
    )
    tidy(axes)
    axes.grid(False, axis="x")


def _log_axis(axes: "Axes", results: Sequence[CellResult]) -> None:
    """A logarithmic axis around all intervals and the encoder's choice."""
    ends = [bootstrap_interval(values) for result in results for values in result.errors.values()]
    encoded = [result.encoded for result in results]
    low, high = min(float(low) for low, _ in ends), max(float(high) for _, high in ends)
    axes.set_yscale("log")
    axes.set_ylim(min(low, *encoded) / ROOM, max(high, *encoded) * ROOM)
    plain_ticks(axes)
