"""Figure: a robot at its task, with the tool's demonstrated paths and the goals."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from latentarm.core.figure_style import SMALL_FONT_SIZE, legend_below, literal, new_figure, save_figure
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.robots.robot import Robot
from latentarm.tasks.place import Place
from latentarm_research.drives.drive_figures import GOAL_COLOURS, GOAL_MARKERS

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D

LINK_COLOUR = "#dfe3e8"
AROUND = 14
ALONG = 5
"""Points around and along a capsule's round end, enough to look smooth at column width."""

DRAWN_EPISODES = 24

SHORTEST_M = 0.6
"""Length of an axis, at least, m."""


def draw_task(task: Place, demonstrations: Demonstrations, path: Path) -> None:
    """Draw the arm at home, where the tool went in the demonstrations, and the goals.

    Each demonstration has the name of its goal in its text; the first `DRAWN_EPISODES` are drawn.
    """
    figure = new_figure(height_mm=95.0, width_mm=120.0)
    axes: Axes3D = figure.add_subplot(projection="3d", computed_zorder=False)
    places = [draw_arm(axes, task.robot, task.robot.home)]
    for episode in demonstrations.episodes[:DRAWN_EPISODES]:
        way = task.robot.chain.forward(episode.state).position
        meant = next(index for index, goal in enumerate(task.goals) if goal.name in episode.task)
        colour = GOAL_COLOURS[meant % len(GOAL_COLOURS)]
        axes.plot(*way.T, color=colour, linewidth=0.7, alpha=0.55, zorder=3)
        places.append(way)
    for index, goal in enumerate(task.goals):
        axes.plot(
            *goal.pose.position[:, None],
            color=GOAL_COLOURS[index % len(GOAL_COLOURS)],
            marker=GOAL_MARKERS[index % len(GOAL_MARKERS)],
            markeredgecolor="black",
            linestyle="none",
            label=literal(goal.name),
            zorder=4,
        )
    frame(axes, np.concatenate(places))
    legend_below(figure, *axes.get_legend_handles_labels())
    save_figure(figure, path)


def draw_arm(axes: "Axes3D", robot: Robot, state: FloatArray) -> FloatArray:
    """Draw the robot's capsules in one state (n,), and return the places that they take, (K, 3), m."""
    transforms = robot.chain.link_transforms(state)
    start, end = robot.capsules.placed(robot.chain, transforms)
    # From far to near, because the drawing has no depth buffer.
    eye = np.array([1.0, -1.2, 0.6])
    for index in np.argsort((start + end) @ eye):
        surface = _capsule(start[index], end[index], float(robot.capsules.radius[index]))
        axes.plot_surface(*surface, color=LINK_COLOUR, linewidth=0, antialiased=False, shade=True, zorder=2)
    return np.concatenate([start, end])


def _capsule(start: FloatArray, end: FloatArray, radius: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The surface of a capsule as three grids of coordinates."""
    along = end - start
    length = float(np.linalg.norm(along))
    axis = along / length if length > 0 else np.array([0.0, 0.0, 1.0])
    side = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    rise = np.linspace(-np.pi / 2, 0.0, ALONG)
    height = np.concatenate([radius * np.sin(rise), length + radius * np.sin(rise + np.pi / 2)])
    width = np.concatenate([radius * np.cos(rise), radius * np.cos(rise + np.pi / 2)])
    turn = np.linspace(0.0, 2 * np.pi, AROUND)
    points = (
        start
        + height[:, None, None] * axis
        + width[:, None, None] * (np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other)
    )
    return points[..., 0], points[..., 1], points[..., 2]


def frame(axes: "Axes3D", places: FloatArray) -> None:
    """Equal scale on all axes, around what is drawn; no axis is too short for its labels."""
    lowest, highest = places.min(axis=0) - 0.05, places.max(axis=0) + 0.05
    short = np.maximum(SHORTEST_M - (highest - lowest), 0.0)
    lowest, highest = lowest - short / 2, highest + short / 2
    axes.set_xlim(lowest[0], highest[0])
    axes.set_ylim(lowest[1], highest[1])
    axes.set_zlim(min(lowest[2], 0.0), highest[2])
    axes.set_box_aspect(highest - np.array([lowest[0], lowest[1], min(lowest[2], 0.0)]))
    axes.view_init(elev=24, azim=-52)
    axes.set_xlabel("x (m)", fontsize=SMALL_FONT_SIZE)
    axes.set_ylabel("y (m)", fontsize=SMALL_FONT_SIZE)
    axes.set_zlabel("z (m)", fontsize=SMALL_FONT_SIZE)
    axes.tick_params(labelsize=SMALL_FONT_SIZE)
    axes.locator_params(nbins=4)
