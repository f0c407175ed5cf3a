"""Drawing for the figures of all studies: panels, titles, legends, and planar arms."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from latentarm.core.figure_style import (
    FONT_SIZE,
    SMALL_FONT_SIZE,
    TWO_COLUMNS_MM,
    legend_below,
    new_figure,
    tidy,
)
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase, SubFigure

DECADES: Final = 100.0  # ratio of a logarithmic axis' ends above which powers of ten are enough as labels
ARM_COLOUR: Final = "#9aa3ad"
JOINT_COLOUR: Final = "#3c434b"

View = tuple[tuple[float, float], tuple[float, float]]
"""What a panel shows of the plane: x from and to, y from and to, m."""


def panel_grid(
    heading: str,
    down: int,
    across: int,
    row_mm: float,
    frame_mm: float,
    *,
    width_mm: float = TWO_COLUMNS_MM,
    **shared: Any,  # which axes panels share, as for `subplots`
) -> "tuple[Figure, Any]":
    """A figure with a heading, and its panels, an array (down, across)."""
    figure = new_figure(row_mm * down + frame_mm, width_mm)
    figure.suptitle(heading, fontsize=FONT_SIZE)
    return figure, figure.subplots(down, across, squeeze=False, **shared)


def first_panels(panels: Any, count: int) -> "list[Axes]":
    """The first of an array of panels, row by row; the others are removed."""
    every = list(panels.flat)
    for axes in every[count:]:
        axes.remove()
    return every[:count]


def label_axes(panels: "Iterable[Axes]", x: str = "", y: str = "") -> None:
    """Label the axes of panels; an empty label leaves what is there."""
    for axes in panels:
        if x:
            axes.set_xlabel(x, fontsize=FONT_SIZE)
        if y:
            axes.set_ylabel(y, fontsize=FONT_SIZE)


def stacked_parts(figure: "Figure", heights_mm: Sequence[float]) -> "list[SubFigure]":
    """The figure cut into rows, each of which gets its panels."""
    parts = figure.subfigures(len(heights_mm), 1, height_ratios=heights_mm, squeeze=False)
    return list(np.ravel(parts))


def row_of_panels(part: "FigureBase", count: int) -> "list[Axes]":
    """A row of panels that share their axes; empty if there is nothing to show."""
    return list(part.subplots(1, count, sharex=True, sharey=True, squeeze=False)[0]) if count else []


def title(axes: "Axes", text: str, letter: str = "") -> None:
    """A title at the left edge, after a bold letter where the caption needs one."""
    bold = f"$\\bf{{{letter}}}$  " if letter else ""
    axes.set_title(bold + text, loc="left", fontsize=FONT_SIZE)


def plane(
    axes: "Axes",
    view: View,
    ticks: int = 4,  # numbers along an axis, at most; fewer for a narrow panel
) -> None:
    """A panel in the plane of the arm: the same scale both ways, in metres.

    What lies outside the view is cut off. Of panels that share their y axis only the first is labelled.
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


def name_series(figure: "Figure", *panels: "Axes", handle_length: float = 3.0) -> None:
    """A legend below all panels, from the labels of some of them; what has a name twice is named once."""
    named = {
        label: handle
        for axes in panels
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if named:
        legend_below(figure, list(named.values()), list(named), handle_length=handle_length)


def arm_line(
    robot: Robot,
    state: FloatArray,  # (..., n), rad
    tool: int = 0,
) -> FloatArray:
    """The joints of one arm from its base outwards and its tool, in the plane, (..., J + 1, 2), m."""
    chain = robot.chain
    transforms = chain.link_transforms(state)
    link = chain.tools[tool].link
    links = np.flatnonzero(chain.moves[link])
    joints = transforms[..., links, :2, 3]
    end = chain.tool_pose(transforms, tool).position[..., None, :2]
    return np.concatenate([joints, end], axis=-2)


def draw_arm(axes: "Axes", robot: Robot, state: FloatArray) -> None:
    """Draw all arms of a robot in one state (n,), with their joints and a mark on each base."""
    for tool in range(len(robot.chain.tools)):
        line = arm_line(robot, state, tool)
        axes.plot(*line.T, color=ARM_COLOUR, linewidth=2.4, solid_capstyle="round", zorder=3)
        axes.plot(*line[1:-1].T, "o", color="white", markeredgecolor=JOINT_COLOUR, markersize=2.6, zorder=3.1)
        axes.plot(*line[0], "s", color=JOINT_COLOUR, markersize=4.0, zorder=3.1)
        axes.plot(*line[-1], "o", color="black", markersize=3.0, zorder=6)


def draw_pose(axes: "Axes", robot: Robot, state: FloatArray, colour: str) -> None:
    """Draw all arms of a robot in one state (n,) as thin lines in one colour."""
    for tool in range(len(robot.chain.tools)):
        line = arm_line(robot, state, tool)
        axes.plot(*line.T, color=colour, linewidth=0.9, solid_capstyle="round", zorder=4)
        axes.plot(*line[-1], "o", color=colour, markersize=2.2, zorder=5)
