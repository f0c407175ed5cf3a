"""The tool's ways, its distance from the plates over time, and where the stick was."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import (
    FONT_SIZE,
    SMALL_FONT_SIZE,
    TWO_COLUMNS_MM,
    legend_below,
    literal,
    new_figure,
    tidy,
)
from latentarm.core.types import FloatArray
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.report.boxes import colours
from latentarm_research.user_studies.trace import BINS, Trace

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

VIEWS: Final = (("from above", 1, 0, "y (m)", "x (m)"), ("from the side", 0, 2, "x (m)", "z (m)"))
"""Name, axis across, axis up, and their labels."""

ROW_MM: Final = 48.0
NARROWEST: Final = 0.75
"""Of a view's shorter side, as a share of the longer one, so that its numbers have room."""

LEGEND_MM: Final = 9.0
SHARES: Final = 50  # points of a drive along which distances are compared


def way_figure(definition: Definition, task: StudyTask, traces: Sequence[Trace], who: str) -> "Figure":
    """The tool's way in everybody's first trial: a column per condition, from above and from the side."""
    from matplotlib.lines import Line2D

    looks, conditions = colours(definition), definition.conditions
    figure = new_figure(ROW_MM * len(VIEWS) + LEGEND_MM, TWO_COLUMNS_MM)
    panels = figure.subplots(len(VIEWS), len(conditions), squeeze=False, sharex="row", sharey="row")
    for row, (view, across, up, x_label, y_label) in zip(panels, VIEWS, strict=True):
        for axes, condition in zip(row, conditions, strict=True):
            for one in traces:
                if (one.task, one.condition, one.trial) != (task.name, condition.name, 0):
                    continue
                place, colour = np.array(one.position), looks[condition.name]
                axes.plot(place[:, across], place[:, up], color=colour, linewidth=0.7, alpha=0.8)
                axes.plot(*place[0, [across, up]], "o", color="black", markersize=2.0)
                axes.plot(*place[-1, [across, up]], "x", color=colour, markersize=3.0)
            axes.set_xlabel(x_label)
            if axes is row[0]:
                axes.set_ylabel(f"{view}\n{y_label}")
            if view == VIEWS[0][0]:
                axes.set_title(literal(condition.name))
            axes.locator_params(axis="x", nbins=2)
            axes.locator_params(axis="y", nbins=4)
            tidy(axes)
            axes.set_aspect("equal", adjustable="box")
        _widen(row[0])
    ends = [Line2D([], [], marker=mark, color="black", linestyle="", markersize=3.0) for mark in "ox"]
    legend_below(figure, ends, ["start", "end"], heading=f"{who}: first trial of each person, {task.label}")
    return figure


def plate_figure(definition: Definition, traces: Sequence[Trace], who: str) -> "Figure":
    """Distance of the tool from the closest plate over the share of a trial: mean and middle half."""
    from matplotlib.lines import Line2D

    looks = colours(definition)
    tasks = [task for task in definition.tasks if task.plates]
    figure = new_figure(62.0, TWO_COLUMNS_MM)
    panels = figure.subplots(1, len(tasks), squeeze=False)[0]
    for axes, task in zip(panels, tasks, strict=True):
        for condition in definition.conditions:
            courses = _courses(traces, task, condition.name)
            if not len(courses):
                continue
            share = np.linspace(0.0, 100.0, SHARES)
            low, high = np.quantile(courses, (0.25, 0.75), axis=0)
            axes.fill_between(share, low, high, color=looks[condition.name], alpha=0.15, linewidth=0.0)
            axes.plot(share, courses.mean(axis=0), color=looks[condition.name], linewidth=1.2)
        axes.set_title(task.label)
        axes.set_xlabel("share of the trial (%)")
        axes.set_ylabel("to the closest plate (m)")
        axes.set_ylim(bottom=0.0)
        tidy(axes)
    handles = [Line2D([], [], color=looks[one.name]) for one in definition.conditions]
    names = [literal(one.name) for one in definition.conditions]
    legend_below(figure, handles, names, heading=f"{who}: mean; shaded is the middle half")
    return figure


def stick_figure(definition: Definition, task: StudyTask, traces: Sequence[Trace], who: str) -> "Figure":
    """Where the stick was, all people together: a panel for each condition, darkest where it was longest."""
    conditions = definition.conditions
    figure = new_figure(58.0 if len(conditions) < 5 else 48.0, TWO_COLUMNS_MM)
    panels = figure.subplots(1, len(conditions), squeeze=False, sharey=True)[0]
    for axes, condition in zip(panels, conditions, strict=True):
        here = [one for one in traces if (one.task, one.condition) == (task.name, condition.name)]
        spent = sum((np.array(one.stick) for one in here), np.zeros((BINS, BINS)))
        _heat(axes, spent)
        axes.set_title(literal(condition.name), fontsize=FONT_SIZE)
    panels[0].set_ylabel("second axis", fontsize=SMALL_FONT_SIZE)
    heading = f"{who}: share of the time that the stick is pushed, {task.label}"
    figure.suptitle(heading, fontsize=SMALL_FONT_SIZE)
    return figure


def _widen(axes: "Axes") -> None:
    """Make a panel's view no narrower than `NARROWEST` of its height, and no lower than that of its width."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    width, height = right - left, high - low
    across, up = max(width, NARROWEST * height), max(height, NARROWEST * width)
    axes.set_xlim((left + right - across) / 2.0, (left + right + across) / 2.0)
    axes.set_ylim((low + high - up) / 2.0, (low + high + up) / 2.0)


def _heat(axes: "Axes", spent: FloatArray) -> None:
    total = float(spent.sum())
    axes.imshow(
        spent / total if total else spent,
        origin="lower",
        extent=(-1.0, 1.0, -1.0, 1.0),
        cmap="Blues",
        vmin=0.0,
        interpolation="nearest",
    )
    axes.set_xlabel("first axis")
    axes.set_xticks((-1, 0, 1))
    axes.set_yticks((-1, 0, 1))
    axes.tick_params(labelsize=SMALL_FONT_SIZE)
    axes.xaxis.label.set_fontsize(SMALL_FONT_SIZE)


def _courses(traces: Sequence[Trace], task: StudyTask, condition: str) -> FloatArray:
    """Distances (N, SHARES) over the share of each trial, m."""
    share = np.linspace(0.0, 1.0, SHARES)
    return np.array(
        [
            np.interp(share, np.linspace(0.0, 1.0, len(one.plate_m)), one.plate_m)
            for one in traces
            if (one.task, one.condition) == (task.name, condition) and one.plate_m
        ]
    )
