"""The study's figure: conditions as in the paper's figure 12."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import legend_below, tidy
from latentarm.evaluation.looks import look_of
from latentarm_research.studies import drawing
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.preset import CONDITIONS
from latentarm_research.studies.alignment.tables import ENCODED
from latentarm_research.studies.statistics import bootstrap_interval, reach_of_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


HEADING: Final = "Relative alignment error, mean over runs with 95 % interval; people and arm simulated"

CONDITIONS_ROW_MM: Final = 48.0
CONDITIONS_FRAME_MM: Final = 20.0
GROUP: Final = 0.86  # width of a group of conditions; groups are 1 apart
ROOM: Final = 1.6  # free room below and above everything on the logarithmic axis, as a factor


def conditions_figure(
    results: Sequence[AlignmentErrors],
    tasks: Sequence[str],
    noises: Sequence[float],  # coefficients of variation of the answers
) -> "Figure":
    """Means with 95 % intervals, a panel per task, grouped by noise."""
    size = 1, len(tasks), CONDITIONS_ROW_MM, CONDITIONS_FRAME_MM
    figure, (line,) = drawing.panel_grid(HEADING, *size, sharex=True, sharey="row")
    for axes, task in zip(line, tasks, strict=True):
        _draw_conditions(axes, [result for result in results if result.cell.task == task])
        drawing.title(axes, look_of(task).label)
        axes.set_xticks(range(len(noises)), [f"{noise:g}" for noise in noises])
    _log_axis(line[0], results)
    drawing.label_axes(line[:1], y="relative error")
    drawing.label_axes(line, x="coefficient of variation of answers")
    (dotted, *points), (encoded, *names) = line[0].get_legend_handles_labels()
    legend_below(figure, [*points, dotted], [*names, encoded])
    return figure


def _draw_conditions(axes: "Axes", results: Sequence[AlignmentErrors]) -> None:
    """All conditions of one task, one group per noise, and the encoder's own choice."""
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
    axes.axhline(results[0].encoded, color="black", linestyle=":", linewidth=0.9, label=ENCODED, zorder=3)
    tidy(axes)
    axes.grid(False, axis="x")


def _log_axis(axes: "Axes", results: Sequence[AlignmentErrors]) -> None:
    """A logarithmic axis around all intervals and the encoder's choice."""
    ends = [bootstrap_interval(values) for result in results for values in result.errors.values()]
    encoded = [result.encoded for result in results]
    low, high = min(float(low) for low, _ in ends), max(float(high) for _, high in ends)
    axes.set_yscale("log")
    axes.set_ylim(min(low, *encoded) / ROOM, max(high, *encoded) * ROOM)
    drawing.plain_ticks(axes)
