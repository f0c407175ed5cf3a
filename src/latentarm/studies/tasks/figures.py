"""The study's figure: how far the runs of each task came."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.metrics.looks import look_of
from latentarm.studies.drawing import name_series, title
from latentarm.studies.tasks.runs import Condition, Run, step_names, through
from latentarm.style import FONT_SIZE, SMALL_FONT_SIZE, TWO_COLUMNS_MM, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACROSS: Final = 3
"""Panels in a row, at most."""

ROW_MM: Final = 62.0
FRAME_MM: Final = 16.0

UNAWARE: Final = "joints"
"""The context that knows nothing of things: its markers are hollow."""

NUDGE: Final = 0.09
"""How far conditions stand from each other, in steps, so that no line hides another."""


def steps_figure(by_task: Mapping[str, Mapping[Condition, Sequence[Run]]]) -> "Figure":
    """The share of the runs that got through each step, a panel per task.

    Args:
        by_task: all runs, by task and condition.
    """
    across = min(ACROSS, len(by_task))
    down = -(-len(by_task) // across)
    figure = new_figure(ROW_MM * down + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "Share of the runs that got through each step; people and arm simulated", fontsize=FONT_SIZE
    )
    panels = np.ravel(figure.subplots(down, across, sharey=True, squeeze=False))
    for axes, (task, runs) in zip(panels, by_task.items(), strict=False):
        _draw(axes, runs)
        title(axes, look_of(task).label)
        axes.set_ylabel("runs (%)" if axes.get_subplotspec().is_first_col() else "", fontsize=FONT_SIZE)
    for axes in panels[len(by_task) :]:
        axes.set_visible(False)
    name_series(figure, *panels[: len(by_task)])
    return figure


def _draw(axes: "Axes", runs: Mapping[Condition, Sequence[Run]]) -> None:
    names = step_names([run for of in runs.values() for run in of])
    middle = (len(runs) - 1) / 2
    for index, (condition, of) in enumerate(runs.items()):
        look = look_of(condition.model or condition.name)
        shares = 100.0 * np.array(through(of))
        axes.plot(
            np.arange(len(shares)) + (index - middle) * NUDGE,
            shares,
            color=look.colour,
            marker=look.marker,
            markerfacecolor="white" if condition.name == UNAWARE else look.colour,
            linestyle=look.dash,
            markersize=3.4,
            linewidth=1.1,
            label=condition.label,
        )
    axes.set_xticks(range(len(names) + 1), ["start", *names], rotation=60, ha="right", rotation_mode="anchor")
    axes.set_ylim(-4.0, 104.0)
    tidy(axes)
    axes.tick_params(axis="x", labelsize=SMALL_FONT_SIZE)
