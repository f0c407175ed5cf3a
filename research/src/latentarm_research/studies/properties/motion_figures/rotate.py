"""The figure of rotate, after the paper's."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, TWO_COLUMNS_MM, new_figure, shade
from latentarm.core.types import FloatArray, Row
from latentarm_research.studies import drawing
from latentarm_research.studies.properties.motion_figures.shown import (
    CONDITIONED,
    CONTRASTED,
    GRID,
    Decoders,
    DrawnModel,
    draw_losses_and_effects,
    draw_states,
    passed_states,
    spread_states,
    turned,
)
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.resolved_rate import plane_point
from latentarm_research.tasks.planar.rotate import BOX_DEPTH_M, BOX_WIDTH_M, Rotate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTS_MM: Final = (52.0, 42.0, 76.0)
HOLD_S: Final = 0.3
ROLLOUT_S: Final = 1.2
BETWEEN_POSES_S: Final = 0.4
POSES: Final = (-1.0, 1.0)
BOX_COLOUR: Final = "#bfe3f5"
BOX_EDGE: Final = "#6fb3d9"
ROLLOUT_VIEW: Final = ((-0.05, 0.95), (-0.56, 0.46))
BOX_VIEW: Final = ((0.35, 0.85), (-0.22, 0.22))


def rotate_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; how z turns the box in three states, each about its own fixed point; rollouts of z = +1.

    Positive z turns counterclockwise in all models.
    """
    motion = Rotate()
    states = passed_states(motion)
    turn = motion.headings(states).mean(axis=-1)
    upright = states[np.abs(turn) < np.quantile(np.abs(turn), 0.3)]
    three = spread_states(upright, _middle(motion, upright)[:, 0], 3)
    shown = turned(decoders, CONTRASTED, states, lambda state: motion.headings(state).mean(axis=-1))
    near = [model for model in shown if model.model in CONDITIONED]

    figure = new_figure(sum(PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Rotate: two simulated planar arms of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = drawing.stacked_parts(figure, PARTS_MM)
    draw_losses_and_effects(
        parts[0],
        rows,
        motion.name,
        near,
        lambda model: _turn_deg(motion, model, three),
        "turn",
        f"turned in {HOLD_S:g} s (deg)",
    )
    draw_states(parts[1], near, three, partial(_draw_turns, motion), BOX_VIEW)
    start = spread_states(states, turn, 12)[0]
    for axes, model in zip(drawing.row_of_panels(parts[2], len(shown)), shown, strict=True):
        _draw_rotate_rollout(axes, motion, model, start)
        drawing.title(axes, f"{model.look.label}, z = +1", "C" if model is shown[0] else "")
        drawing.plane(axes, ROLLOUT_VIEW)
    return figure


def _turn_deg(motion: Rotate, model: DrawnModel, states: FloatArray) -> FloatArray:
    """How far the grippers turn from each state, on average of the two, counterclockwise: (K, N), deg."""
    ends = model.hold(states, GRID[:, None], HOLD_S)[:, :, -1]
    return np.degrees(motion.headings(ends) - motion.headings(states)).mean(axis=-1)


def _grips(motion: Rotate, state: FloatArray) -> FloatArray:
    """Places (..., 2, 2) of the left and the right gripper, m."""
    return np.stack([plane_point(motion.robot, state, arm) for arm in (0, 1)], axis=-2)


def _middle(motion: Rotate, state: FloatArray) -> FloatArray:
    """The place (..., 2) midway between the grippers, m: the box's fixed point."""
    return _grips(motion, state).mean(axis=-2)


def _draw_box(axes: "Axes", motion: Rotate, state: FloatArray, colour: str, fill: str | None = None) -> None:
    """The box as the grippers hold it: each carries its own side, so disagreement tears the shape."""
    heading = motion.headings(state)[:, None]
    half = BOX_DEPTH_M / 2 * np.concatenate([np.cos(heading), np.sin(heading)], axis=-1)
    left, right = _grips(motion, state)
    corners = np.array([left - half[0], left + half[0], right + half[1], right - half[1]])
    axes.fill(*corners.T, facecolor=fill or "none", edgecolor=colour, linewidth=1.0, zorder=2.5)


def _draw_turns(motion: Rotate, axes: "Axes", model: DrawnModel, state: FloatArray) -> None:
    """The box in one state, and where z = -1 (pale) and z = +1 (dark) turn it."""
    ends = model.hold(state[None], np.array(POSES)[:, None], HOLD_S)[:, 0, -1]
    _draw_box(axes, motion, state, BOX_EDGE, BOX_COLOUR)
    drawing.draw_arm(axes, motion.robot, state)
    for z, pose in zip(POSES, ends, strict=True):
        drawing.draw_pose(axes, motion.robot, pose, shade(model.look.colour, z))
        _draw_box(axes, motion, pose, shade(model.look.colour, z))
    axes.plot(*_middle(motion, state), "+", color="black", markersize=6, zorder=7)


def _draw_rotate_rollout(axes: "Axes", motion: Rotate, model: DrawnModel, start: FloatArray) -> None:
    """Both arms and the box while z = +1 is held: pale at first, then darker."""
    passed = model.hold(start[None], np.ones((1, 1)), ROLLOUT_S)[0, 0]
    _draw_box(axes, motion, start, BOX_EDGE, BOX_COLOUR)
    drawing.draw_arm(axes, motion.robot, start)
    every = round(BETWEEN_POSES_S / STEP_S)
    for moment in range(every, len(passed), every):
        colour = shade(model.look.colour, 2 * moment / (len(passed) - 1) - 1)
        drawing.draw_pose(axes, motion.robot, passed[moment], colour)
        _draw_box(axes, motion, passed[moment], colour)
    left, right = np.moveaxis(_grips(motion, passed), -2, 0)
    off = np.abs(np.linalg.norm(left - right, axis=-1) - BOX_WIDTH_M).max()
    drawing.note(axes, f"grip on the box off by up to {1000 * off:.0f} mm")
