"""The figure of sine, after the paper's."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, TWO_COLUMNS_MM, new_figure, shade
from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.effects import axis_grid
from latentarm_research.studies.drawing import draw_arm, draw_pose, plane, row_of_panels, stacked_parts, title
from latentarm_research.studies.properties.motion_figures.shown import (
    CONDITIONED,
    CONTRASTED,
    GRID,
    Decoders,
    DrawnModel,
    draw_guides,
    draw_losses_and_effects,
    draw_states,
    passed_states,
    spread_states,
    turned,
)
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.resolved_rate import plane_point
from latentarm_research.tasks.planar.sine import Sine

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTS_MM: Final = (50.0, 34.0, 50.0, 42.0)
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
    three = spread_states(states, along, 3)
    shown = turned(decoders, CONTRASTED, states, lambda state: plane_point(motion.robot, state)[..., 0])
    near = [model for model in shown if model.model in CONDITIONED]

    figure = new_figure(sum(PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Sine: a simulated planar arm of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, PARTS_MM)
    draw_losses_and_effects(
        parts[0],
        rows,
        motion.name,
        near,
        lambda model: _signed_distance_mm(motion, model, three),
        "distance",
        f"moved in {HOLD_S:g} s (mm)",
    )
    draw_states(parts[1], near, three, partial(_draw_poses, motion), ARM_VIEW)
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


def _signed_distance_mm(motion: Sine, model: DrawnModel, states: FloatArray) -> FloatArray:
    """How far the tool gets from each state, to the right positive: (K, N), mm."""
    ends = model.hold(states, GRID[:, None], HOLD_S)[:, :, -1]
    moved = plane_point(motion.robot, ends) - plane_point(motion.robot, states)
    return 1000.0 * np.sign(moved[..., 0]) * np.linalg.norm(moved, axis=-1)


def _draw_poses(motion: Sine, axes: "Axes", model: DrawnModel, state: FloatArray) -> None:
    """The arm in one state, and where z takes it: pale for z < 0, dark for z > 0."""
    draw_guides(axes, motion)
    ends = model.hold(state[None], POSES[:, None], HOLD_S)[:, 0, -1]
    for z, pose in zip(POSES, ends, strict=True):
        draw_pose(axes, motion.robot, pose, shade(model.look.colour, z))
    draw_arm(axes, motion.robot, state)


def _draw_sine_rollout(axes: "Axes", motion: Sine, model: DrawnModel, start: FloatArray) -> None:
    """The tool's path while z = +1 is held, and the arm on the way: pale at first, then darker."""
    draw_guides(axes, motion)
    passed = model.hold(start[None], np.ones((1, 1)), ROLLOUT_S)[0, 0]
    every = round(BETWEEN_POSES_S / STEP_S)
    for moment in range(every, len(passed), every):
        draw_pose(axes, motion.robot, passed[moment], shade(model.look.colour, 2 * moment / len(passed) - 1))
    draw_arm(axes, motion.robot, start)
    axes.plot(*plane_point(motion.robot, passed).T, color=model.look.colour, linewidth=1.6, zorder=5)


def _draw_sine_paths(axes: "Axes", motion: Sine, model: DrawnModel, starts: FloatArray) -> None:
    """Paths of the tool from several states (dots) while z = +1 (solid) and z = -1 (dashed) are held."""
    draw_guides(axes, motion)
    both = model.hold(starts, np.array([[1.0], [-1.0]]), ROLLOUT_S)
    for paths, dash in zip(plane_point(motion.robot, both), ("-", "--"), strict=True):
        axes.plot(paths[..., 0].T, paths[..., 1].T, color=model.look.colour, linestyle=dash, linewidth=0.9)
    axes.plot(*plane_point(motion.robot, starts).T, "o", color="black", markersize=2.5, zorder=6)
