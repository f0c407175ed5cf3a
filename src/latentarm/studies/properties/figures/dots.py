"""Panel: one point per model with its SD and its figure, and the paper's beside it."""

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Final

from latentarm.metrics.table import format_figure
from latentarm.studies.properties.figures.panels import Point
from latentarm.style import SMALL_FONT_SIZE, look_of, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BELOW: Final = 0.25
"""How far the paper's figure stands below ours, so that no SD is taken for the other."""
DECADES: Final = 50.0
"""Ratio of the ends of a logarithmic axis from which powers of ten are numbers enough."""
PAPER_SIGN: Final = "($\\diamond$: the paper)"


def log_axis(axes: "Axes", figures: Collection[Point], least: float = 0.0) -> float:
    """Make the x axis logarithmic, around all figures and the paper's.

    Args:
        axes: the panel.
        figures: all that are drawn.
        least: the axis goes no further down.

    Returns:
        Its left edge.
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set_xscale("log")
    spans = [(figure.mean, figure.mean + figure.sd) for figure in figures]
    spans += [(figure.paper, figure.paper) for figure in figures if figure.paper is not None]
    left = max(0.5 * min((low for low, _ in spans if low > 0), default=1.0), least)
    right = 1.6 * max((high for _, high in spans), default=1.0)
    axes.set_xlim(left, max(right, 2 * left))
    between = (1.0,) if right > DECADES * left else (1.0, 2.0, 5.0)
    axes.xaxis.set_major_locator(LogLocator(subs=between))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    return left


def draw_points(axes: "Axes", figures: Mapping[str, Point], left: float, least: float = 0.0) -> None:
    """Draw points with their SD, named on the left and with their figures on the right.

    An SD that reaches the left edge goes on beyond it, on a logarithmic axis as far as zero.
    Points and not bars, because a bar's length means nothing on a logarithmic axis.

    Args:
        axes: where to draw; its scale is already set.
        figures: by model.
        left: the left edge of the axis.
        least: a figure below it is no point, but the words that it is, at the left edge.
    """
    for place, (model, figure) in enumerate(figures.items()):
        if figure.mean < least:
            axes.annotate(
                f"< {least:g}",
                (left, place),
                (2.0, 0.0),
                textcoords="offset points",
                fontsize=SMALL_FONT_SIZE,
                verticalalignment="center_baseline",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},  # no grid line through them
            )
            continue
        look = look_of(model)
        draw_spread(axes, place, figure.mean, figure.sd, left)
        axes.plot(figure.mean, place, look.marker, color=look.colour, markersize=5.5, zorder=7)
        draw_paper(axes, place + BELOW, figure, left)
        axes.text(
            1.02,
            place,
            format_figure(figure.mean, figure.sd),
            transform=axes.get_yaxis_transform(),
            fontsize=SMALL_FONT_SIZE,
            verticalalignment="center_baseline",
        )
    axes.set_yticks(range(len(figures)), [look_of(model).label for model in figures])
    axes.set_ylim(len(figures) - 0.4, -0.6)
    tidy(axes)
    axes.grid(False, axis="y")


def draw_spread(axes: "Axes", place: float, mean: float, sd: float, left: float) -> None:
    """One SD to either side of a mean, no further down than the left edge."""
    ends = [max(mean - sd, left), mean + sd]
    axes.plot(ends, [place, place], color="black", linewidth=0.9, zorder=4)


def draw_paper(axes: "Axes", place: float, figure: Point, left: float) -> None:
    """The paper's figure, where there is one: a hollow diamond with its SD."""
    if figure.paper is None:
        return
    draw_spread(axes, place, figure.paper, figure.paper_sd, left)
    axes.plot(figure.paper, place, "d", markersize=5.0, color="white", markeredgecolor="black", zorder=6)


def beside(figures: Mapping[str, Point]) -> str:
    """What the axis' label adds where figures of the paper are drawn."""
    return f"   {PAPER_SIGN}" if any(figure.paper is not None for figure in figures.values()) else ""
