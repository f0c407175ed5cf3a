"""The figure of reach, after the paper's."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, TWO_COLUMNS_MM, new_figure, shade
from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.effects import axis_grid
from latentarm_research.studies.drawing import draw_arm, plane, row_of_panels, stacked_parts, title
from latentarm_research.studies.properties.figures import draw_losses, draw_points, in_mm, log_axis, points
from latentarm_research.studies.properties.held_motion import Decoders, DrawnModel, passed_states, turned
from latentarm_research.tasks.planar.reach import DISTANCE_M, DURATION_S, ReachRegion
from latentarm_research.tasks.planar.resolved_rate import plane_point

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTS_MM: Final = (52.0, 64.0)
HELD: Final = axis_grid(9)
VIEW: Final = ((-0.5, 0.3), (-0.06, 0.62))
REGION_COLOUR: Final = "#fdf3c4"


def reach_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; final distances; tool paths from one start while z is held, for nine values of z.

    Positive z leads upwards in all models.
    """
    motion = ReachRegion()
    states = passed_states(motion)
    shown = turned(decoders, states, lambda state: plane_point(motion.robot, state)[..., 1])
    figure = new_figure(sum(PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Reach: a simulated planar arm of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, PARTS_MM)
    losses, distances = parts[0].subplots(1, 2)
    draw_losses(losses, rows, motion.name)
    final = in_mm(points(rows, motion.name, "final_distance"))
    draw_points(distances, final, log_axis(distances, final.values()))
    title(distances, "distance to the goal in the end", "B")
    distances.set_xlabel("mm")
    for axes, model in zip(row_of_panels(parts[1], len(shown)), shown, strict=True):
        _draw_reach_paths(axes, motion, model, _middle_start(motion, states))
        title(axes, f"{model.look.label}, z from −1 (pale) to +1", "C" if model is shown[0] else "")
        plane(axes, VIEW)
    return figure


def _middle_start(motion: ReachRegion, states: FloatArray) -> FloatArray:
    """A state (n,) at the middle of the start side."""
    wanted = motion.region[:-1].mean(axis=0) - (DISTANCE_M, 0.0)
    return states[np.argmin(np.linalg.norm(plane_point(motion.robot, states) - wanted, axis=-1))]


def _draw_reach_paths(axes: "Axes", motion: ReachRegion, model: DrawnModel, start: FloatArray) -> None:
    """The arm at the start, the goal region, and the tool's path for each value of z."""
    axes.fill(*motion.region.T, facecolor=REGION_COLOUR, edgecolor="black", linewidth=0.8, zorder=1)
    paths = plane_point(motion.robot, model.hold(start[None], HELD[:, None], DURATION_S)[:, 0])
    draw_arm(axes, motion.robot, start)
    for z, path in zip(HELD, paths, strict=True):
        axes.plot(*path.T, color=shade(model.look.colour, z), linewidth=1.2, zorder=5)
        axes.plot(*path[-1], model.look.marker, color=shade(model.look.colour, z), markersize=3.0, zorder=5.5)
