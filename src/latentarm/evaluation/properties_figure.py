"""Figure: how far each latent axis moves the end-effector, against z, over all states."""

from typing import TYPE_CHECKING

import numpy as np

from latentarm.core.style import FONT_SIZE, SMALL_FONT_SIZE, new_figure, tidy
from latentarm.core.types import FloatArray
from latentarm.evaluation.consistency import line_fit, r_squared, signed_distance
from latentarm.evaluation.looks import look_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MM_PER_M = 1000.0


def properties_figure(effects: FloatArray, grid: FloatArray, model: str) -> "Figure":
    """Signed distance of effects (d, N, K, 3), m, of one seed against z, in one panel per axis.

    Each panel has a faint line per state and the best-fit line.
    """
    signed = MM_PER_M * signed_distance(effects, grid)
    figure = new_figure(height_mm=48.0)
    panels = figure.subplots(1, len(signed), sharey=True, squeeze=False)[0]
    for axis, (axes, distance) in enumerate(zip(panels, signed, strict=True)):
        _draw_axis(axes, grid, distance, model)
        axes.set_title(f"axis {axis + 1}")
        axes.set_xlabel(f"$z_{axis + 1}$")
    panels[0].set_ylabel("signed distance in a step (mm)")
    for axes in panels:
        tidy(axes)
    figure.suptitle(look_of(model).label, fontsize=FONT_SIZE)
    return figure


def _draw_axis(axes: "Axes", grid: FloatArray, distance: FloatArray, model: str) -> None:
    """One axis' panel: distance (N, K), mm."""
    look = look_of(model)
    axes.plot(grid, distance.T, color=look.colour, linewidth=0.6, alpha=0.45)
    z, flat = np.broadcast_to(grid, distance.shape).reshape(-1), distance.reshape(-1)
    slope, intercept = line_fit(z, flat)
    axes.plot(grid, slope * grid + intercept, color="black", linewidth=1.4, linestyle="--")
    axes.text(
        0.04,
        0.96,
        f"$R^2$ = {float(r_squared(z, flat)):.2f}",
        transform=axes.transAxes,
        verticalalignment="top",
        fontsize=SMALL_FONT_SIZE,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
    )
    axes.set_xlim(-1.05, 1.05)
    axes.set_xticks([-1.0, 0.0, 1.0])
