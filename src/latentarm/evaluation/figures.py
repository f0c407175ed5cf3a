"""Figures: where the tool goes while a latent axis is held, and how far each axis moves it against z."""

from typing import TYPE_CHECKING

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, SMALL_FONT_SIZE, legend_below, new_figure, tidy
from latentarm.core.types import FloatArray
from latentarm.evaluation.consistency import line_fit, r_squared, signed_distance
from latentarm.evaluation.contract import DecodesActions
from latentarm.evaluation.effects import held_paths
from latentarm.evaluation.looks import look_of
from latentarm.robots.kinematics.chain import Chain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from latentarm.models.way_back.runtime import WayBack

AXIS_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
HOLD_S = 1.0
BASE_AXES = "xyz"
AWAY_M = 0.04  # the way back is drawn from this far off the starts, m
AROUND = 6  # directions in which the way back is drawn


def latent_effect_figure(
    decoder: DecodesActions,
    context: FloatArray,
    chain: Chain,
    step_s: float,
    model: str,
    demonstrated: FloatArray | None = None,
    way_back: "WayBack | None" = None,
) -> "Figure":
    """Paths of the tool over one second of ±1 on each latent axis, from each of a few contexts (N, c).

    A path ends in a filled marker for +1 and in an open one for -1. The view is along the base axis in which
    the drawn paths differ least. A demonstration's places (T, 3), m, are drawn behind, and the way back as
    arrows around the starts. ``model`` names the model in the title.
    """
    dim = decoder.latent_dim
    ends = np.concatenate([np.eye(dim), -np.eye(dim)])
    paths = held_paths(decoder, context, ends, chain, step_s, max(1, round(HOLD_S / step_s)))
    behind = np.zeros((0, 3)) if demonstrated is None else demonstrated
    places = np.concatenate([paths.reshape(-1, 3), behind])
    across, up = sorted(np.argsort(np.ptp(places, axis=0))[1:])
    figure = new_figure(height_mm=95.0)
    axes = figure.subplots()
    if len(behind):
        axes.plot(behind[:, across], behind[:, up], color="#bbbbbb", linewidth=1.0, label="demonstrated")
    if way_back is not None:
        _draw_way_back(axes, way_back, context, (across, up))
    for axis in range(dim):
        _draw_axis(axes, paths[[axis, axis + dim]][..., [across, up]], axis)
    axes.plot(paths[0, :, 0, across], paths[0, :, 0, up], "k+", markersize=7, label="start")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{BASE_AXES[across]} (m)")
    axes.set_ylabel(f"{BASE_AXES[up]} (m)")
    axes.set_title(f"{look_of(model).label}, held for {HOLD_S:g} s")
    tidy(axes)
    legend_below(figure, *axes.get_legend_handles_labels())
    axes.title.set_fontsize(FONT_SIZE)
    return figure


def _draw_way_back(axes: "Axes", way_back: "WayBack", context: FloatArray, view: tuple[int, int]) -> None:
    """Arrows from a ring around the tool's place in each context (N, c), seen along the third axis."""
    turn = 2 * np.pi / AROUND * np.arange(AROUND)
    offset = np.zeros((AROUND, 1, 3))
    offset[..., view] = AWAY_M * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None]
    context = np.broadcast_to(context, (AROUND, *context.shape))
    here, there = (places.reshape(-1, 3)[:, view] for places in way_back.leads(context, offset))
    for start, end in zip(here, there, strict=True):
        arrow = {"arrowstyle": "->", "color": "#777777", "linewidth": 0.7, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", end, start, arrowprops=arrow | {"mutation_scale": 3.5})
    axes.plot(*here.T, ".", color="#777777", markersize=2.0)
    label = f"way back from {100 * AWAY_M:g} cm away"
    axes.plot([], [], color="#777777", linewidth=0.8, marker=">", markersize=3.0, markevery=[-1], label=label)


def _draw_axis(axes: "Axes", paths: FloatArray, axis: int) -> None:
    """Paths (2, N, T, 2) of one latent axis, m: first those of +1, then those of -1."""
    colour = AXIS_COLOURS[axis % len(AXIS_COLOURS)]
    for sign, side, dash in (("+", paths[0], "-"), ("-", paths[1], "--")):
        for index, path in enumerate(side):
            axes.plot(
                path[:, 0],
                path[:, 1],
                color=colour,
                linewidth=1.3,
                linestyle=dash,
                marker="o" if axis % 2 == 0 else "s",
                markevery=[-1],
                markersize=4.0,
                markerfacecolor=colour if sign == "+" else "white",
                label=f"$z_{axis + 1} = {sign}1$" if index == 0 else None,
            )


MM_PER_M = 1000.0


def properties_figure(effects: FloatArray, grid: FloatArray, model: str) -> "Figure":
    """Signed distance of effects (d, N, K, 3), m, of one seed against z, in one panel per axis.

    Each panel has a faint line per state and the best-fit line.
    """
    signed = MM_PER_M * signed_distance(effects, grid)
    figure = new_figure(height_mm=48.0)
    panels = figure.subplots(1, len(signed), sharey=True, squeeze=False)[0]
    for axis, (axes, distance) in enumerate(zip(panels, signed, strict=True)):
        _draw_panel(axes, grid, distance, model)
        axes.set_title(f"axis {axis + 1}")
        axes.set_xlabel(f"$z_{axis + 1}$")
    panels[0].set_ylabel("signed distance in a step (mm)")
    for axes in panels:
        tidy(axes)
    figure.suptitle(look_of(model).label, fontsize=FONT_SIZE)
    return figure


def _draw_panel(axes: "Axes", grid: FloatArray, distance: FloatArray, model: str) -> None:
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
