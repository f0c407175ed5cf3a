"""Where the tool goes, with each alignment: drives to the goals of the demo's table."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.metrics.looks import look_of
from latentarm.simulation.drive_figures import GOAL_COLOURS, GOAL_MARKERS, OUTCOMES, outcome_lines
from latentarm.studies.alignment.drives import DRIVEN, Driven, DrivesResult
from latentarm.studies.drawing import title
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, new_figure, save_figure, tidy
from latentarm.tasks.table_top import TableTop
from latentarm.types import Goal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROW_MM: Final = 36.0
LEGEND_MM: Final = 18.0
VIEW: Final = ((-0.6, 0.6), (-0.2, 0.85))
"""What is shown, y from and to, x from and to, m."""


def draw_drive_paths(results: Sequence[DrivesResult], path: Path) -> None:
    """Draw all paths until the goal from above: models down, conditions across.

    Args:
        results: one for each kind of model.
        path: the PNG to write.

    Raises:
        UserError: the file cannot be written.
    """
    goals = TableTop().goals
    figure = new_figure(height_mm=ROW_MM * len(results) + LEGEND_MM, width_mm=TWO_COLUMNS_MM)
    figure.set_layout_engine("compressed")  # panels keep their shape; without it the rest of a row is blank
    figure.suptitle("Simulated drives from above, and how many reach their goal", fontsize=FONT_SIZE)
    panels = figure.subplots(len(results), len(DRIVEN), squeeze=False, sharex=True, sharey=True)
    for row, result in zip(panels, results, strict=True):
        for axes, condition in zip(row, DRIVEN, strict=True):
            drives = result.drives[condition]
            _draw(axes, drives, goals)
            name = condition.replace(", ", ",\n")
            title(axes, f"{name}\n{sum(one.reached_s is not None for one in drives)} of {len(drives)}")
        row[0].set_ylabel(f"{look_of(result.cell.model).label}: x (m)")
    for axes in panels[-1]:
        axes.set_xlabel("y (m)")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, [*handles, *outcome_lines()], [*labels, *OUTCOMES])
    save_figure(figure, path)


def _draw(axes: "Axes", drives: Sequence[Driven], goals: Sequence[Goal]) -> None:
    for one in drives:
        axes.plot(
            one.path[:, 1],
            one.path[:, 0],
            color=GOAL_COLOURS[one.goal],
            linestyle=OUTCOMES["goal not reached" if one.reached_s is None else "goal reached"],
            linewidth=0.6,
            alpha=0.6,
        )
    for index, goal in enumerate(goals):
        axes.plot(
            goal.pose.position[1],
            goal.pose.position[0],
            marker=GOAL_MARKERS[index],
            color=GOAL_COLOURS[index],
            markeredgecolor="black",
            markersize=4.5,
            linestyle="none",
            label=goal.name,
        )
    axes.set_xlim(*VIEW[0])
    axes.set_ylim(*VIEW[1])
    axes.set_aspect("equal", adjustable="box")
    axes.locator_params(nbins=3)
    tidy(axes)
