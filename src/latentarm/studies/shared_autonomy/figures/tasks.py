"""Figure: an arm before two cups, with the tool's paths in a few demonstrations."""

from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.simulation.arm_figure import draw_arm as draw_solid_arm
from latentarm.simulation.arm_figure import frame
from latentarm.simulation.drive_figures import GOAL_COLOURS, GOAL_MARKERS
from latentarm.studies.panels import plane
from latentarm.studies.planar_arms import arm_line
from latentarm.studies.planar_arms import draw_arm as draw_planar_arm
from latentarm.style import FONT_SIZE, legend_below, look_of, new_figure
from latentarm.tasks.two_cups import BEARING_RAD, Place, PlanarTwoCups, TwoCups
from latentarm.types import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.axes3d import Axes3D

HEIGHT_MM: Final = 74.0
DRAWN: Final = 12
"""Demonstrations that are drawn."""

STREAM: Final = 82
"""Keeps them apart from those of the study; they are always the same."""

MARGIN_M: Final = 0.06

AT_THE_CUP: Final = Place(back=0.0, left=0.0, up=0.0, turn=0.0)


def task_figure(task: TwoCups) -> "Figure":
    """The arm at its start, the goals before the cups and where the tool goes from there."""
    figure = new_figure(HEIGHT_MM)
    figure.suptitle(f"Two cups, {look_of(task.name).label}; all simulated", fontsize=FONT_SIZE)
    demonstrations = task.demonstrate(DRAWN, np.random.default_rng(STREAM))
    chain = task.robot.chain
    paths = [chain.forward(episode.state).position for episode in demonstrations.episodes]
    goals = np.stack([goal.pose.position for goal in task.goals])
    nearest = [int(np.linalg.norm(path[:, None] - goals, axis=-1).min(axis=0).argmin()) for path in paths]
    if isinstance(task, PlanarTwoCups):
        axes: Axes = figure.add_subplot()
        draw_planar_arm(axes, task.robot, task.start)
        _draw_paths(axes, task, [path[:, :2] for path in paths], nearest)
        places = np.concatenate([*(path[:, :2] for path in paths), arm_line(task.robot, task.start)])
        low, high = places.min(axis=0) - MARGIN_M, places.max(axis=0) + MARGIN_M
        plane(axes, ((low[0], high[0]), (low[1], high[1])))
    else:
        solid: Axes3D = figure.add_subplot(projection="3d", computed_zorder=False)
        places = draw_solid_arm(solid, task.robot, task.start)
        _draw_paths(solid, task, paths, nearest)
        frame(solid, np.concatenate([places, *paths]))
    legend_below(figure, *figure.axes[0].get_legend_handles_labels(), handle_length=1.0)
    return figure


def _draw_paths(axes: "Axes", task: TwoCups, paths: list[FloatArray], led_to: list[int]) -> None:
    """Paths (T, 2) or (T, 3) in the colour of the cup that they lead to, and the goals."""
    for path, cup in zip(paths, led_to, strict=True):
        axes.plot(*path.T, color=GOAL_COLOURS[cup], linestyle=("-", "--")[cup], linewidth=0.8, zorder=4)
    axis_count = paths[0].shape[1]
    for cup, goal in enumerate(task.goals):
        axes.plot(
            *goal.pose.position[:axis_count, None],
            color=GOAL_COLOURS[cup],
            marker=GOAL_MARKERS[cup],
            markeredgecolor="black",
            markersize=4.0,
            linestyle="none",
            label=f"before the {goal.name}",
            zorder=5,
        )
    cups = np.stack([task.pose(bearing, AT_THE_CUP).position for bearing in (BEARING_RAD, -BEARING_RAD)])
    axes.plot(
        *cups[:, :axis_count].T,
        color="black",
        marker="o",
        markerfacecolor="none",
        markersize=9.0,
        linestyle="none",
        label="cups",
        zorder=3.5,
    )
