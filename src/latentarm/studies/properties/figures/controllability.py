"""Figure: how near latent actions alone bring the tool to its goal, on every task."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.studies.panels import title
from latentarm.studies.properties.figures.dots import draw_points, log_axis
from latentarm.studies.properties.figures.panels import in_mm, points
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, new_figure
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW_MM: Final = 52.0
ACROSS: Final = 2
LEAST_MM: Final = 0.001
"""A distance below this is rounding: with as many latent axes as the plane has, any model comes so near."""


def measure_of(task: str) -> str:
    """The measure that says so: on the reach task goals are places, elsewhere states."""
    return "final_distance" if task == "reach" else "controllability_m"


def controllability_figure(rows: Sequence[Row], tasks: Sequence[str]) -> "Figure":
    """Least distance of the tool from its goal, one panel per task, with the distance at the start.

    Args:
        rows: of the study.
        tasks: those that were run.
    """
    down = -(-len(tasks) // ACROSS)
    figure = new_figure(down * ROW_MM + 6.0, TWO_COLUMNS_MM)
    figure.suptitle(
        "How near simulated arms come to their goals by latent actions alone, mean ± SD over seeds",
        fontsize=FONT_SIZE,
    )
    panels = list(figure.subplots(down, ACROSS, squeeze=False).flat)
    for axes, task in zip(panels, tasks, strict=False):
        distances = in_mm(points(rows, task, measure_of(task)))
        starts = in_mm(points(rows, task, "start_distance_m"))
        left = log_axis(axes, [*distances.values(), *starts.values()], LEAST_MM)
        draw_points(axes, distances, left, LEAST_MM)
        for start in list(starts.values())[:1]:  # the same pairs for all models
            axes.axvline(
                start.mean, color="black", linestyle=":", linewidth=1.0, zorder=1, label="at the start"
            )
        title(axes, task.capitalize())
        axes.set_xlabel("tool from goal (mm)")
    for axes in panels[len(tasks) :]:
        axes.remove()
    handles, labels = panels[0].get_legend_handles_labels()
    if handles:
        legend_below(figure, handles, labels)
    return figure
