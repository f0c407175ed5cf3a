"""One look for every figure, legible without colour."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.core.files import written_whole
from latentarm.core.untrusted.terminal import visible

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Look:
    """How one model or condition is drawn everywhere.

    Attributes:
        label: its name as people read it.
        colour: hex colour of the Okabe-Ito palette (distinct for colour-blind readers).
        marker: matplotlib marker, so that series differ in grey too.
        dash: matplotlib line style, by name or as (offset, lengths of ink and gap in line widths).
    """

    label: str
    colour: str
    marker: str
    dash: str | tuple[float, tuple[float, ...]]


FIGURE_DPI = 200
COLUMN_MM = 85.0
TWO_COLUMNS_MM = 175.0
FONT_SIZE = 8.0
SMALL_FONT_SIZE = 7.0
MM_PER_INCH = 25.4
LEGEND_MARGIN_MM = 4.0
"""Width kept free around a legend, both sides together."""


def tidy(axes: "Axes") -> None:
    """Remove the upper and right frame lines and draw a faint grid behind the data."""
    axes.spines["top"].set_visible(False)
    axes.spines["right"].set_visible(False)
    axes.grid(True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=SMALL_FONT_SIZE)
    axes.title.set_fontsize(FONT_SIZE)
    axes.xaxis.label.set_fontsize(FONT_SIZE)
    axes.yaxis.label.set_fontsize(FONT_SIZE)


MOST_CHARACTERS: Final = 40
"""Longest name in a figure; longer ones are cut."""


def literal(text: str) -> str:
    """Text from outside, for a figure: shortened, with dollar signs escaped."""
    shown = visible(text)
    if len(shown) > MOST_CHARACTERS:
        shown = f"{shown[: MOST_CHARACTERS - 1]}…"
    return shown.replace("$", "\\$")


def shade(colour: str, depth: float) -> str:
    """A model's colour from pale to dark, to grade one series without another colour.

    Args:
        colour: hex colour.
        depth: from -1, mostly white, to 1, a little darker than the colour itself.

    Returns:
        Hex colour.
    """
    from matplotlib.colors import to_hex, to_rgb

    white = 0.4 - (0.4 if depth > 0 else 0.35) * depth
    black = max(0.25 * depth, 0.0)
    red, green, blue = (white + (1.0 - white - black) * channel for channel in to_rgb(colour))
    return to_hex((red, green, blue))


def new_figure(height_mm: float, width_mm: float = COLUMN_MM) -> "Figure":
    """An empty figure of a print column's width that lays out its panels so that nothing is cut off.

    It belongs to no global state, so figures can be drawn anywhere, in threads too.
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")


def legend_below(
    figure: "Figure",
    handles: "Sequence[Artist]",
    labels: Sequence[str],
    *,
    heading: str | None = None,
    handle_length: float = 2.0,
) -> None:
    """A legend under all panels, in as many columns as fit the figure's width, so that none is cut off.

    Args:
        figure: its size is set.
        handles: what is named.
        labels: of each.
        heading: over the legend.
        handle_length: of the samples of lines, in font sizes.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(figure).get_renderer()
    room = figure.bbox.width - LEGEND_MARGIN_MM / MM_PER_INCH * figure.dpi
    for rows in range(1, len(labels) + 1):
        legend = figure.legend(
            handles,
            labels,
            loc="outside lower center",
            ncols=-(-len(labels) // rows),
            frameon=False,
            fontsize=SMALL_FONT_SIZE,
            title=heading,
            title_fontsize=SMALL_FONT_SIZE,
            handlelength=handle_length,
            columnspacing=1.4,
        )
        if rows == len(labels) or legend.get_window_extent(renderer).width <= room:
            return
        legend.remove()


def save_figure(figure: "Figure", path: Path) -> None:
    """Write a figure as PNG, whole or not at all.

    Raises:
        UserError: the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with written_whole(path) as part:
        FigureCanvasAgg(figure)
        figure.savefig(part, format="png", dpi=FIGURE_DPI)
