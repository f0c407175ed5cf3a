"""Figures of drives: the tool's paths from above and from the side, and inputs over time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, legend_below, new_figure, save_figure, tidy
from latentarm.core.types import FloatArray, Goal
from latentarm.evaluation.looks import look_of
from latentarm_research.drives.trace import Trace

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

GOAL_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
GOAL_MARKERS = ("o", "s", "^", "D", "v", "P")
OUTCOMES: Final[dict[str, Literal["-", ":"]]] = {"goal reached": "-", "goal not reached": ":"}
"""Outcome of a drive -> line style of its path."""

PANEL_MM = 51.0
WIDTH_MM = 170.0

TICKS: Final = 3
"""Intervals across a panel, at most: a narrow one has no room for the labels of more."""


@final
@dataclass(frozen=True, eq=False)
class Mark:
    """Where a drive led to, or was to."""

    name: str  # for the legend, where it stands once
    goal: int  # index of what it was for, which decides the colour
    position: FloatArray  # (3,), m


def marks_of_goals(goals: Sequence[Goal]) -> list[Mark]:
    """Goals that lie in the same place in all drives."""
    return [Mark(goal.name, index, goal.pose.position) for index, goal in enumerate(goals)]


def marks_of_first_steps(traces: Sequence[Trace]) -> list[Mark]:
    """Where the first step of each drive leads, which lies elsewhere in each."""
    return [Mark(trace.steps[0].name, trace.choice, trace.target) for trace in traces]


def draw_drives(traces: Mapping[str, Sequence[Trace]], marks: Sequence[Mark], path: Path) -> None:
    """Draw where the tool went, from above and from the side, one column per condition."""
    figure = new_figure(height_mm=2 * PANEL_MM, width_mm=max(WIDTH_MM * len(traces) / 3, 85.0))
    panels = figure.subplots(2, len(traces), squeeze=False, sharex="row", sharey="row")
    for column, (condition, drives) in enumerate(traces.items()):
        _draw_view(panels[0, column], drives, marks, across=1, up=0)
        _draw_view(panels[1, column], drives, marks, across=1, up=2)
        done = sum(trace.figures.success for trace in drives)
        panels[0, column].set_title(f"{look_of(condition).label}\n{done} of {len(drives)} drives succeed")
    panels[0, 0].set_ylabel("from above: x (m)")
    panels[1, 0].set_ylabel("from the front: z (m)")
    for axes in panels[1]:
        axes.set_xlabel("y (m)")
    for axes in panels.flat:
        tidy(axes)
        axes.locator_params(axis="x", nbins=TICKS)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, [*handles, *outcome_lines()], [*labels, *OUTCOMES])
    save_figure(figure, path)


def outcome_lines() -> "list[Line2D]":
    """Samples for the legend, in the order of `OUTCOMES`."""
    from matplotlib.lines import Line2D

    return [Line2D([], [], color="black", linestyle=dash, linewidth=0.9) for dash in OUTCOMES.values()]


def _draw_view(axes: "Axes", drives: Sequence[Trace], marks: Sequence[Mark], across: int, up: int) -> None:
    for trace in drives:
        axes.plot(
            trace.position[:, across],
            trace.position[:, up],
            color=GOAL_COLOURS[trace.choice % len(GOAL_COLOURS)],
            linestyle=OUTCOMES["goal reached" if trace.figures.success else "goal not reached"],
            linewidth=0.7,
            alpha=0.6,
        )
    named: set[str] = set()
    for mark in marks:
        axes.plot(
            mark.position[across],
            mark.position[up],
            marker=GOAL_MARKERS[mark.goal % len(GOAL_MARKERS)],
            color=GOAL_COLOURS[mark.goal % len(GOAL_COLOURS)],
            markeredgecolor="black",
            markersize=6,
            linestyle="none",
            label=None if mark.name in named else mark.name,
        )
        named.add(mark.name)
    axes.set_aspect("equal", adjustable="box")


def draw_inputs(traces: Mapping[str, Sequence[Trace]], path: Path) -> None:
    """Draw the typical drive of each condition over time: what the person did, and when they changed modes.

    Typical is the drive that takes the median time.
    """
    figure = new_figure(height_mm=30.0 * len(traces) + 15.0, width_mm=WIDTH_MM)
    panels = figure.subplots(len(traces), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (condition, drives) in zip(panels, traces.items(), strict=True):
        trace = median_drive(drives)
        for axis in range(trace.input.shape[1]):
            axes.plot(
                trace.time_s,
                trace.input[:, axis],
                drawstyle="steps-post",
                color=GOAL_COLOURS[axis],
                linestyle=("-", "--")[axis % 2],
                linewidth=0.9,
                label=f"axis {axis + 1}",
            )
        switches = trace.time_s[1:][np.diff(trace.mode) != 0]
        for moment in switches:
            axes.axvline(moment, color="black", linewidth=0.8, linestyle=":", label="mode switch")
        outcome = "done" if trace.figures.success else "not done"
        said = f"{outcome} after {trace.time_s[-1]:.1f} s, the median of {len(drives)} drives"
        if len(switches):
            said += f"; {len(switches)} mode switches"
        axes.set_title(f"{look_of(condition).label}: {said}", loc="left", fontsize=FONT_SIZE)
        axes.set_ylim(-1.15, 1.15)
        axes.set_ylabel("input u")
        tidy(axes)
    panels[-1].set_xlabel("time (s)")
    named = {
        label: handle
        for axes in panels
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    legend_below(figure, list(named.values()), list(named))
    save_figure(figure, path)


def median_drive(drives: Sequence[Trace]) -> Trace:
    """The drive that takes the median time; of an even number, the shorter of the two in the middle."""
    return sorted(drives, key=lambda trace: float(trace.time_s[-1]))[(len(drives) - 1) // 2]
