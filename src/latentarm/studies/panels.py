"""What the panels of all figures have in common."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.style import FONT_SIZE, SMALL_FONT_SIZE, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase, SubFigure

DECADES: Final = 100.0
"""Ratio of the ends of a logarithmic axis from which powers of ten are numbers enough."""

View = tuple[tuple[float, float], tuple[float, float]]
"""What a panel shows of the plane: x from and to, y from and to, m."""


def stacked_parts(figure: "Figure", heights_mm: Sequence[float]) -> "list[SubFigure]":
    """The figure cut into parts above each other, each to have panels of its own."""
    parts = figure.subfigures(len(heights_mm), 1, height_ratios=heights_mm, squeeze=False)
    return list(np.ravel(parts))


def row_of_panels(part: "FigureBase", count: int) -> "list[Axes]":
    """So many panels beside each other that share their axes; none where there is nothing to show."""
    return list(part.subplots(1, count, sharex=True, sharey=True, squeeze=False)[0]) if count else []


def title(axes: "Axes", text: str, letter: str = "") -> None:
    """A title at the left edge, after a bold letter where the caption needs one."""
    bold = f"$\\bf{{{letter}}}$  " if letter else ""
    axes.set_title(bold + text, loc="left", fontsize=FONT_SIZE)


def plane(axes: "Axes", view: View, ticks: int = 4) -> None:
    """A panel in the plane of the arm: the same scale both ways, in metres.

    What lies outside the view is cut off. Of panels that share their y axis only the first is labelled.

    Args:
        axes: the panel.
        view: what it shows.
        ticks: numbers along an axis, at most; fewer for a narrow panel.
    """
    axes.set_xlim(*view[0])
    axes.set_ylim(*view[1])
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    axes.locator_params(nbins=ticks)
    tidy(axes)
    axes.grid(False)
    axes.label_outer()


def plain_ticks(axes: "Axes") -> None:
    """Numbers such as 0.2 along a logarithmic y axis: powers of ten, in a short one 2 and 5 too."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0,) if high > DECADES * low else (1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())


def note(axes: "Axes", text: str, *, high: bool = False) -> None:
    """Small print in the left corner of a panel, at the bottom or at the top."""
    axes.text(
        0.03,
        0.97 if high else 0.03,
        text,
        transform=axes.transAxes,
        fontsize=SMALL_FONT_SIZE,
        verticalalignment="top" if high else "bottom",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8},
        zorder=9,
    )
