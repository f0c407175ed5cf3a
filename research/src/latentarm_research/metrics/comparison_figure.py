"""Figure: every measure for every model or condition, mean with SD, one small panel per measure."""

import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from latentarm.core.style import SMALL_FONT_SIZE, new_figure, tidy
from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import measure_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACROSS = 3  # panels in a row
LABEL_WIDTH = 17  # characters of a series' name before it breaks
TITLE_WIDTH = 14  # of a panel's
LINE_MM = 3.2  # height of a line of small print
GAP_MM = 1.0  # between two series
FRAME_MM = 14.0  # a panel's title and numbers


def comparison_figure(
    rows: Sequence[Row],  # figures of one task, of several models or (where they name one) conditions
) -> "Figure":
    """Means with bars of one SD to either side, series down and measures across.

    Series are told apart by place, marker and name as well as by colour.
    """
    measures = list(dict.fromkeys(row.measure for row in rows))
    series = list(dict.fromkeys(_series(row) for row in rows))
    down = math.ceil(len(measures) / ACROSS)
    labels = [_wrapped(look_of(name).label, LABEL_WIDTH) for name in series]
    lines = 1 + max((label.count("\n") for label in labels), default=0)
    figure = new_figure(height_mm=down * (len(series) * (LINE_MM * lines + GAP_MM) + FRAME_MM))
    panels = figure.subplots(down, min(ACROSS, len(measures)), sharey=True, squeeze=False)
    for axes in panels.flat[len(measures) :]:
        axes.remove()
    for axes, measure in zip(panels.flat, measures, strict=False):
        chosen = [row for row in rows if row.measure == measure]
        _draw_measure(axes, chosen, series)
        tidy(axes)
        axes.set_title(_wrapped(measure_name(chosen[0]), TITLE_WIDTH), fontsize=SMALL_FONT_SIZE)
        axes.set_yticks(range(len(series)), labels)
        axes.set_ylim(len(series) - 0.5, -0.5)
    return figure


def _wrapped(text: str, width: int) -> str:
    """The text wrapped to lines of at most ``width`` characters."""
    return textwrap.fill(text, width, break_on_hyphens=False)


def _series(row: Row) -> str:
    """The name that decides a row's look: its condition's where it has one."""
    return row.condition or row.model or row.study


def _draw_measure(axes: "Axes", rows: Sequence[Row], series: Sequence[str]) -> None:
    """One measure's panel; a missing value leaves a gap."""
    for row in rows:
        if row.mean is None:
            continue
        look = look_of(_series(row))
        axes.errorbar(
            row.mean,
            series.index(_series(row)),
            xerr=row.sd or 0.0,
            color=look.colour,
            marker=look.marker,
            markersize=4.5,
            capsize=2.0,
            linewidth=1.2,
        )
    low, high = axes.get_xlim()
    low, high = min(low, 0.0), max(high, 0.0)
    room = 0.1 * (high - low)  # for a whole marker at either end
    axes.set_xlim(low - room, high + room)
    axes.locator_params(axis="x", nbins=3)
    # "0.01", not "0.010": three numbers have to fit under a narrow panel.
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
