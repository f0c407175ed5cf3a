"""The figure of sine, after the paper's."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from latentarm.core.figure_style import (
    FONT_SIZE,
    SMALL_FONT_SIZE,
    TWO_COLUMNS_MM,
    new_figure,
    shade,
    tidy,
)
from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.effects import axis_grid
from latentarm.evaluation.table import format_figure
from latentarm_research.studies.drawing import (
    draw_arm,
    draw_pose,
    note,
    plane,
    row_of_panels,
    stacked_parts,
    title,
)
from latentarm_research.studies.properties.figures import draw_losses, points
from latentarm_research.studies.properties.held_motion import (
    Decoders,
    DrawnModel,
    passed_states,
    spread_states,
    turned,
)
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.resolved_rate import plane_point
from latentarm_research.tasks.planar.sine import HALF_LENGTH_M, Sine

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTS_MM: Final = (50.0, 34.0, 50.0, 42.0)
GRID: Final = axis_grid(21)  # values of z over which its effect is drawn
DASHES: Final = ("-", "--", ":")  # of the three states in which it is drawn
WAVE_COLOUR: Final = "#bbbbbb"
HOLD_S: Final = 0.3
"""How long z is held for part B: long enough to be seen, short enough to stay near the state."""
ROLLOUT_S: Final = 0.8
BETWEEN_POSES_S: Final = 0.2
ROLLOUTS: Final = 7
POSES: Final = axis_grid(5)
ARM_VIEW: Final = ((-0.65, 0.5), (-0.06, 0.63))
WAVE_VIEW: Final = ((-0.55, 0.1), (0.08, 0.4))


def sine_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; what z does at three states; rollouts of z = +1 with the arm; tool paths of many rollouts.

    Positive z goes to the right in all models.
    """
    motion = Sine()
    states = passed_states(motion)
    along = plane_point(motion.robot, states)[:, 0]
    three = spread_states(states, along, len(DASHES))
    shown = turned(decoders, states, lambda state: plane_point(motion.robot, state)[..., 0])
    near = [model for model in shown if model.model != "vae"]

    figure = new_figure(sum(PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Sine: a simulated planar arm of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, PARTS_MM)
    losses, *panels = parts[0].subplots(1, 1 + len(near), squeeze=False)[0]
    draw_losses(losses, rows, motion.name)
    for place, (axes, model) in enumerate(zip(panels, near, strict=True)):
        _draw_effects(axes, rows, motion, model, three)
        title(axes, f"{model.look.label}, distance", "" if place else "B")
    for place, axes in enumerate(row_of_panels(parts[1], len(three) * len(near))):
        model, state = divmod(place, len(three))
        _draw_poses(motion, axes, near[model], three[state])
        title(axes, f"{near[model].look.label}, state {state + 1}")
        plane(axes, ARM_VIEW, ticks=3)
    start = spread_states(states, along, 12)[0]
    for axes, model in zip(row_of_panels(parts[2], len(shown)), shown, strict=True):
        _draw_sine_rollout(axes, motion, model, start)
        title(axes, f"{model.look.label}, z = +1", "C" if model is shown[0] else "")
        plane(axes, ARM_VIEW)
    starts = spread_states(states, along, ROLLOUTS)
    for axes, model in zip(row_of_panels(parts[3], len(shown)), shown, strict=True):
        _draw_sine_paths(axes, motion, model, starts)
        title(axes, f"{model.look.label}, z = +1 (—) and −1 (- -)", "D" if model is shown[0] else "")
        plane(axes, WAVE_VIEW)
    return figure


def _draw_effects(
    axes: "Axes", rows: Sequence[Row], motion: Sine, model: DrawnModel, states: FloatArray
) -> None:
    """The tool's distance from each state over z, and the fit of a line to it over seeds and states."""
    ends = model.hold(states, GRID[:, None], HOLD_S)[:, :, -1]
    moved = plane_point(motion.robot, ends) - plane_point(motion.robot, states)
    distance_mm = 1000.0 * np.sign(moved[..., 0]) * np.linalg.norm(moved, axis=-1)
    for place, (values, dash) in enumerate(zip(distance_mm.T, DASHES, strict=True)):
        look: dict[str, Any] = {"color": model.look.colour, "linestyle": dash, "linewidth": 1.2}
        axes.plot(GRID, values, **look, label=f"state {place + 1}")
    fit = points(rows, motion.name, "r2").get(model.model)
    if fit is not None:
        note(axes, f"$R^2$ = {format_figure(fit.mean, fit.sd)}", high=True)
    axes.set_xlabel("z")
    axes.set_ylabel(f"moved in {HOLD_S:g} s (mm)")
    axes.legend(loc="lower right", fontsize=SMALL_FONT_SIZE, frameon=False, borderaxespad=0.0)
    tidy(axes)


def _draw_wave(axes: "Axes", motion: Sine) -> None:
    """The wave, in grey behind everything."""
    wave = motion.curve(np.linspace(-HALF_LENGTH_M, HALF_LENGTH_M, 200))
    axes.plot(*wave.T, color=WAVE_COLOUR, linewidth=1.6, zorder=2)


def _draw_poses(motion: Sine, axes: "Axes", model: DrawnModel, state: FloatArray) -> None:
    """The arm in one state, and where z takes it: pale for z < 0, dark for z > 0."""
    _draw_wave(axes, motion)
    ends = model.hold(state[None], POSES[:, None], HOLD_S)[:, 0, -1]
    for z, pose in zip(POSES, ends, strict=True):
        draw_pose(axes, motion.robot, pose, shade(model.look.colour, z))
    draw_arm(axes, motion.robot, state)


def _draw_sine_rollout(axes: "Axes", motion: Sine, model: DrawnModel, start: FloatArray) -> None:
    """The tool's path while z = +1 is held, and the arm on the way: pale at first, then darker."""
    _draw_wave(axes, motion)
    passed = model.hold(start[None], np.ones((1, 1)), ROLLOUT_S)[0, 0]
    every = round(BETWEEN_POSES_S / STEP_S)
    for moment in range(every, len(passed), every):
        draw_pose(axes, motion.robot, passed[moment], shade(model.look.colour, 2 * moment / len(passed) - 1))
    draw_arm(axes, motion.robot, start)
    axes.plot(*plane_point(motion.robot, passed).T, color=model.look.colour, linewidth=1.6, zorder=5)


def _draw_sine_paths(axes: "Axes", motion: Sine, model: DrawnModel, starts: FloatArray) -> None:
    """Paths of the tool from several states (dots) while z = +1 (solid) and z = -1 (dashed) are held."""
    _draw_wave(axes, motion)
    both = model.hold(starts, np.array([[1.0], [-1.0]]), ROLLOUT_S)
    for paths, dash in zip(plane_point(motion.robot, both), ("-", "--"), strict=True):
        axes.plot(paths[..., 0].T, paths[..., 1].T, color=model.look.colour, linestyle=dash, linewidth=0.9)
    axes.plot(*plane_point(motion.robot, starts).T, "o", color="black", markersize=2.5, zorder=6)
