"""Figure, like the paper's Figure 12: the error of every condition, by noise."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.experiments.alignment.cell import CellResult
from latentarm.experiments.alignment.conditions import CONDITIONS, IDEAL
from latentarm.experiments.alignment.rows import ENCODED
from latentarm.experiments.studies.panels import plain_ticks, title
from latentarm.style import FONT_SIZE, SMALL_FONT_SIZE, TWO_COLUMNS_MM, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_MM: Final = 48.0
FRAME_MM: Final = 20.0
GROUP: Final = 0.86
"""Width of a group of bars; groups are 1 apart."""

ROOM: Final = 1.6
"""Free room below and above all bars on the logarithmic axis, as a factor."""


def conditions_figure(
    results: Sequence[CellResult], models: Sequence[str], tasks: Sequence[str], noises: Sequence[float]
) -> "Figure":
    """Bars with their SD, a panel per task, a row per model, grouped by noise.

    Args:
        results: every cell.
        models: those to be shown.
        tasks: from left to right.
        noises: coefficients of variation of the answers.
    """
    figure = new_figure(ROW_MM * len(models) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "Relative alignment error, mean ± SD over runs; people and arm simulated", fontsize=FONT_SIZE
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
    (line, *bars), (encoded, *names) = panels[0, 0].get_legend_handles_labels()
    labels = [*names, encoded]
    figure.legend(
        [*bars, line],
        labels,
        loc="outside lower center",
        ncols=(len(labels) + 1) // 2,
        frameon=False,
        fontsize=SMALL_FONT_SIZE,
        handlelength=1.2,
        columnspacing=1.4,
    )
    return figure


def _draw(axes: "Axes", results: Sequence[CellResult]) -> None:
    """All conditions of one task and model, one group per noise, and the encoder's own choice."""
    width = GROUP / len(CONDITIONS)
    groups = np.arange(len(results))
    for index, name in enumerate(CONDITIONS):
        errors = [result.errors[name] for result in results]
        axes.bar(
            groups + (index - (len(CONDITIONS) - 1) / 2) * width,
            [values.mean() for values in errors],
            width=0.92 * width,
            yerr=[values.std(ddof=1) if len(values) > 1 else 0.0 for values in errors],
            error_kw={"elinewidth": 0.7, "capsize": 0.0},
            color=look_of(name).colour,
            hatch="////" if name == IDEAL else None,
            edgecolor="white",
            linewidth=0.0,
            label=look_of(name).label,
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
    """A logarithmic axis around all means, SDs upwards and the encoder's choice."""
    means = [float(values.mean()) for result in results for values in result.errors.values()]
    spreads = [
        float(values.mean() + values.std(ddof=1))
        for result in results
        for values in result.errors.values()
        if len(values) > 1
    ]
    axes.set_yscale("log")
    axes.set_ylim(min(means + [result.encoded for result in results]) / ROOM, max(means + spreads) * ROOM)
    plain_ticks(axes)
