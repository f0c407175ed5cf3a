"""The look of every figure, legible without colour."""

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
    """The look of one model or condition in every figure."""

    label: str
    colour: str  # hex, of the Okabe-Ito palette, distinct for colour-blind readers
    marker: str  # of matplotlib, so that series differ in grey too
    # matplotlib line style, by name or as (offset, lengths of ink and gap in line widths)
    dash: str | tuple[float, tuple[float, ...]]


FIGURE_DPI = 200
COLUMN_MM = 85.0
TWO_COLUMNS_MM = 175.0
FONT_SIZE = 8.0
SMALL_FONT_SIZE = 7.0
MM_PER_INCH = 25.4
LEGEND_MARGIN_MM = 4.0  # width kept free around a legend, both sides together


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


MOST_CHARACTERS: Final = 40  # longest name in a figure; longer ones are cut


def literal(text: str) -> str:
    """Shorten text from outside for a figure and escape its dollar signs."""
    shown = visible(text)
    if len(shown) > MOST_CHARACTERS:
        shown = f"{shown[: MOST_CHARACTERS - 1]}…"
    return shown.replace("$", "\\$")


def shade(colour: str, depth: float) -> str:
    """Grade a hex colour by depth, from -1 (mostly white) to 1 (a little darker than the colour)."""
    from matplotlib.colors import to_hex, to_rgb

    white = 0.4 - (0.4 if depth > 0 else 0.35) * depth
    black = max(0.25 * depth, 0.0)
    red, green, blue = (white + (1.0 - white - black) * channel for channel in to_rgb(colour))
    return to_hex((red, green, blue))


def new_figure(height_mm: float, width_mm: float = COLUMN_MM) -> "Figure":
    """An empty figure of a print column's width, laid out so that nothing is cut off; thread-safe."""
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
    """A legend under all panels, in as many columns as fit the figure's width."""
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
    """Write a figure as PNG, whole or not at all."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with written_whole(path) as part:
        FigureCanvasAgg(figure)
        figure.savefig(part, format="png", dpi=FIGURE_DPI)
