"""The figure of circle, after the paper's."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, TWO_COLUMNS_MM, new_figure
from latentarm.core.types import FloatArray, Row
from latentarm_research.studies.drawing import plane, row_of_panels, stacked_parts, title
from latentarm_research.studies.properties.figures import beside, draw_losses, draw_points, points
from latentarm_research.studies.properties.motion_figures.shown import (
    CONTRASTED,
    Decoders,
    DrawnModel,
    as_trained,
    draw_guides,
    passed_states,
)
from latentarm_research.tasks.planar.circle import RADII_M, Circle
from latentarm_research.tasks.planar.resolved_rate import plane_point

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTS_MM: Final = (52.0, 72.0)
HOLD_S: Final = 0.25
AROUND: Final = 8  # places on each circle from which arrows are drawn
HALF_VIEW_M: Final = 0.21
SECOND_COLOUR: Final = "#8a8f96"
"""Of z_2, in all models; z_1 has the model's colour."""


def circle_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; angles between the axes; where z_1 and z_2 move the tool at places on two circles."""
    motion = Circle()
    starts = _around(motion, passed_states(motion))
    shown = as_trained(decoders, CONTRASTED)
    figure = new_figure(sum(PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Circle: a simulated planar arm of 5 joints, 2-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, PARTS_MM)
    losses, angles = parts[0].subplots(1, 2)
    draw_losses(losses, rows, motion.name)
    between = points(rows, motion.name, "disentanglement_deg")
    draw_points(angles, between, 0.0)
    title(angles, "angle between the axes", "B")
    angles.set_xlim(0.0, 100.0)
    angles.set_xticks([0, 30, 60, 90])
    angles.set_xlabel(f"deg{beside(between)}")
    (x, y), reach = motion.centre, HALF_VIEW_M
    for axes, model in zip(row_of_panels(parts[1], len(shown)), shown, strict=True):
        _draw_arrows(axes, motion, model, starts)
        title(axes, f"{model.look.label}, $z_1$ (—) and $z_2$ (- -)", "C" if model is shown[0] else "")
        plane(axes, ((x - reach, x + reach), (y - reach, y + reach)))
    return figure


def _around(motion: Circle, states: FloatArray) -> FloatArray:
    """States (2 AROUND, n) with the tool spread evenly along the smallest and the largest circle."""
    angle = 2 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    wanted = motion.centre + np.concatenate([radius * ways for radius in RADII_M])
    distance = np.linalg.norm(plane_point(motion.robot, states) - wanted[:, None], axis=-1)
    return states[np.argmin(distance, axis=1)]


def _draw_arrows(axes: "Axes", motion: Circle, model: DrawnModel, starts: FloatArray) -> None:
    """Where the tool gets from each start (dots) while one axis is held at +1 and the other at 0."""
    draw_guides(axes, motion)
    place = plane_point(motion.robot, starts)
    first, second = plane_point(motion.robot, model.hold(starts, np.eye(2), HOLD_S)[:, :, -1])
    for ends, colour, dash, head in (
        (first, model.look.colour, "-", "-|>"),
        (second, SECOND_COLOUR, (0, (2.5, 1.2)), "->"),
    ):
        for tail, end in zip(place, ends, strict=True):
            axes.annotate(
                "",
                end,
                tail,
                arrowprops={
                    "arrowstyle": head,
                    "color": colour,
                    "linestyle": dash,
                    "linewidth": 1.3,
                    "shrinkA": 0,
                    "shrinkB": 0,
                    "mutation_scale": 7,
                },
                zorder=5,
            )
    axes.plot(*place.T, "o", color="black", markersize=2.5, zorder=6)
