"""A figure for each task, after the paper's: what latent actions do on it.

Each is drawn from one decoder per model, of the first seed, trained without noise, and the study's rows.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.metrics.contract import DecodesActions, next_context
from latentarm.metrics.effects import axis_grid
from latentarm.metrics.looks import look_of
from latentarm.metrics.table import format_figure
from latentarm.studies.drawing import draw_arm, draw_pose, note, plane, row_of_panels, stacked_parts, title
from latentarm.studies.properties.figures import beside, draw_losses, draw_points, in_mm, log_axis, points
from latentarm.studies.properties.tables import OURS
from latentarm.style import FONT_SIZE, SMALL_FONT_SIZE, TWO_COLUMNS_MM, Look, new_figure, shade, tidy
from latentarm.tasks.planar.circle import RADII_M, Circle
from latentarm.tasks.planar.motion import PlanarMotion
from latentarm.tasks.planar.paths import STEP_S
from latentarm.tasks.planar.reach import DISTANCE_M, DURATION_S, ReachRegion
from latentarm.tasks.planar.resolved_rate import plane_point
from latentarm.tasks.planar.rotate import BOX_DEPTH_M, BOX_WIDTH_M, Rotate
from latentarm.tasks.planar.sine import Sine
from latentarm.types import FloatArray, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


CONDITIONED: Final = ("cvae", OURS)
"""The models whose latent action is shown in detail: the one that the paper draws, and ours."""

CONTRASTED: Final = ("vae", *CONDITIONED)
"""The models whose motions are shown side by side; the paper contrasts the first two."""

EPISODES: Final = 60
STREAM: Final = 81
"""Separates the drawn states from those of the study: no model was trained on them."""

Decoders = Mapping[str, DecodesActions]
"""One decoder per model, of the first seed, trained without noise."""


@dataclass(frozen=True)
class Shown:
    """One model as it is drawn on one task.

    Attributes:
        model: its name.
        decoder: of one seed.
        sign: 1 or -1, what z is multiplied by before it is decoded. The sign of a latent axis is chance:
            without this, two models that do the same would look opposed.
    """

    model: str
    decoder: DecodesActions
    sign: float

    @property
    def look(self) -> Look:
        """Its colour, marker and dash."""
        return look_of(self.model)

    def hold(self, start: FloatArray, z: FloatArray, duration_s: float) -> FloatArray:
        """States while a latent action is held.

        Args:
            start: (N, n), states to start from, rad.
            z: (L, d), the latent actions, each held from each start.
            duration_s: how long, s.

        Returns:
            (L, N, T + 1, n), rad.
        """
        latent = np.broadcast_to(self.sign * z[:, None], (len(z), len(start), z.shape[-1]))
        passed = [np.broadcast_to(start, (len(z), *start.shape))]
        for _ in range(round(duration_s / STEP_S)):
            passed.append(next_context(passed[-1], self.decoder.decode(latent, passed[-1]), STEP_S))
        return np.stack(passed, axis=2)


def as_trained(decoders: Decoders, models: Sequence[str]) -> list[Shown]:
    """Those of the models that there are, in the order asked for, with z as it was learned."""
    return [Shown(model, decoders[model], 1.0) for model in models if model in decoders]


def turned(
    decoders: Decoders, models: Sequence[str], states: FloatArray, rising: Callable[[FloatArray], FloatArray]
) -> list[Shown]:
    """The same, with a 1-D z turned so that positive z, on the whole, raises a quantity.

    Args:
        decoders: of all models.
        models: which to show.
        states: (N, n), where to look, rad.
        rising: from states (..., n) to the quantity (...).
    """
    ends = np.array([[-1.0], [1.0]])
    shown: list[Shown] = []
    for plain in as_trained(decoders, models):
        backward, forward = rising(plain.hold(states, ends, STEP_S)[:, :, -1])
        shown.append(Shown(plain.model, plain.decoder, 1.0 if np.sum(forward - backward) >= 0 else -1.0))
    return shown


def passed_states(motion: PlanarMotion) -> FloatArray:
    """States (K, n) of demonstrations that no model has seen, rad; always the same."""
    demonstrations = motion.demonstrate(EPISODES, np.random.default_rng(STREAM))
    return np.concatenate([episode.state for episode in demonstrations.episodes])


def spread_states(states: FloatArray, quantity: FloatArray, count: int) -> FloatArray:
    """States at which a quantity is spread evenly over the middle of its range.

    Args:
        states: (K, n).
        quantity: (K,), of each of them.
        count: how many.

    Returns:
        (count, n), those with the lowest quantity first.
    """
    low, high = np.quantile(quantity, (0.03, 0.97))
    wanted = low + (np.arange(count) + 0.5) / count * (high - low)
    return states[np.argmin(np.abs(quantity - wanted[:, None]), axis=1)]


GUIDE_COLOUR: Final = "#bbbbbb"


def draw_guides(axes: "Axes", motion: PlanarMotion) -> None:
    """Draw the lines that show a task, in grey behind everything."""
    for guide in motion.guides:
        axes.plot(*guide.T, color=GUIDE_COLOUR, linewidth=1.6, zorder=2)


GRID: Final = axis_grid(21)
DASHES: Final = ("-", "--", ":")


def draw_over_z(axes: "Axes", rows: Sequence[Row], task: str, model: str, effect: FloatArray) -> None:
    """Draw an effect over z, and say how well a line fits it over all seeds and more states.

    Args:
        axes: where to draw.
        rows: of the study, for R^2.
        task: which task.
        model: whose effect.
        effect: (K, 3), at the K values of `GRID`, in three states, in the unit of the y axis.
    """
    for place, (values, dash) in enumerate(zip(effect.T, DASHES, strict=True)):
        axes.plot(
            GRID,
            values,
            color=look_of(model).colour,
            linestyle=dash,
            linewidth=1.2,
            label=f"state {place + 1}",
        )
    fit = points(rows, task, "r2").get(model)
    if fit is not None:
        note(axes, f"$R^2$ = {format_figure(fit.mean, fit.sd)}", high=True)
    axes.set_xlabel("z")
    axes.legend(loc="lower right", fontsize=SMALL_FONT_SIZE, frameon=False, borderaxespad=0.0)
    tidy(axes)


SINE_PARTS_MM: Final = (50.0, 34.0, 50.0, 42.0)
SINE_HOLD_S: Final = 0.3
"""How long z is held for part B: long enough to be seen, short enough to stay near the state."""
SINE_ROLLOUT_S: Final = 1.5
SINE_BETWEEN_POSES_S: Final = 0.25
ROLLOUTS: Final = 7
SINE_POSES: Final = axis_grid(5)
ARM_VIEW: Final = ((-0.55, 0.35), (-0.04, 0.5))
SINE_ROLLOUT_VIEW: Final = ((-0.55, 0.4), (-0.04, 0.56))
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

    figure = new_figure(sum(SINE_PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Sine: a simulated planar arm of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, SINE_PARTS_MM)
    losses, *panels = parts[0].subplots(1, 1 + len(near), squeeze=False)[0]
    draw_losses(losses, rows, motion.name)
    for place, (axes, model) in enumerate(zip(panels, near, strict=False)):
        draw_over_z(axes, rows, motion.name, model.model, _signed_distance_mm(motion, model, three))
        title(axes, f"{model.look.label}, distance", "" if place else "B")
        axes.set_ylabel(f"moved in {SINE_HOLD_S:g} s (mm)")
    for place, axes in enumerate(row_of_panels(parts[1], 3 * len(near))):
        model, state = near[place // 3], place % 3
        _draw_poses(axes, motion, model, three[state])
        title(axes, f"{model.look.label}, state {state + 1}")
        plane(axes, ARM_VIEW, ticks=3)
    start = spread_states(states, along, 12)[0]
    for axes, model in zip(row_of_panels(parts[2], len(shown)), shown, strict=True):
        _draw_sine_rollout(axes, motion, model, start)
        title(axes, f"{model.look.label}, z = +1", "C" if model is shown[0] else "")
        plane(axes, SINE_ROLLOUT_VIEW)
    starts = spread_states(states, along, ROLLOUTS)
    for axes, model in zip(row_of_panels(parts[3], len(shown)), shown, strict=True):
        _draw_sine_paths(axes, motion, model, starts)
        title(axes, f"{model.look.label}, z = +1 (—) and −1 (- -)", "D" if model is shown[0] else "")
        plane(axes, WAVE_VIEW)
    return figure


def _signed_distance_mm(motion: Sine, model: Shown, states: FloatArray) -> FloatArray:
    """How far the tool gets from each state, to the right positive: (K, N), mm."""
    ends = model.hold(states, GRID[:, None], SINE_HOLD_S)[:, :, -1]
    moved = plane_point(motion.robot, ends) - plane_point(motion.robot, states)
    return 1000.0 * np.sign(moved[..., 0]) * np.linalg.norm(moved, axis=-1)


def _draw_poses(axes: "Axes", motion: Sine, model: Shown, state: FloatArray) -> None:
    """The arm in one state, and where z takes it: pale for z < 0, dark for z > 0."""
    draw_guides(axes, motion)
    ends = model.hold(state[None], SINE_POSES[:, None], SINE_HOLD_S)[:, 0, -1]
    for z, pose in zip(SINE_POSES, ends, strict=True):
        draw_pose(axes, motion.robot, pose, shade(model.look.colour, z))
    draw_arm(axes, motion.robot, state)


def _draw_sine_rollout(axes: "Axes", motion: Sine, model: Shown, start: FloatArray) -> None:
    """The tool's path while z = +1 is held, and the arm on the way: pale at first, then darker."""
    draw_guides(axes, motion)
    passed = model.hold(start[None], np.ones((1, 1)), SINE_ROLLOUT_S)[0, 0]
    every = round(SINE_BETWEEN_POSES_S / STEP_S)
    for moment in range(every, len(passed), every):
        draw_pose(axes, motion.robot, passed[moment], shade(model.look.colour, 2 * moment / len(passed) - 1))
    draw_arm(axes, motion.robot, start)
    axes.plot(*plane_point(motion.robot, passed).T, color=model.look.colour, linewidth=1.6, zorder=5)


def _draw_sine_paths(axes: "Axes", motion: Sine, model: Shown, starts: FloatArray) -> None:
    """Paths of the tool from several states (dots) while z = +1 (solid) and z = -1 (dashed) are held."""
    draw_guides(axes, motion)
    both = model.hold(starts, np.array([[1.0], [-1.0]]), SINE_ROLLOUT_S)
    for paths, dash in zip(plane_point(motion.robot, both), ("-", "--"), strict=True):
        axes.plot(paths[..., 0].T, paths[..., 1].T, color=model.look.colour, linestyle=dash, linewidth=0.9)
    axes.plot(*plane_point(motion.robot, starts).T, "o", color="black", markersize=2.5, zorder=6)


ROTATE_PARTS_MM: Final = (52.0, 42.0, 76.0)
ROTATE_HOLD_S: Final = 0.3
ROTATE_ROLLOUT_S: Final = 1.2
ROTATE_BETWEEN_POSES_S: Final = 0.4
ROTATE_POSES: Final = (-1.0, 1.0)
BOX_COLOUR: Final = "#bfe3f5"
BOX_EDGE: Final = "#6fb3d9"
BOX_VIEW: Final = ((0.35, 0.85), (-0.22, 0.22))
ROTATE_ROLLOUT_VIEW: Final = ((-0.05, 0.95), (-0.56, 0.46))


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

    figure = new_figure(sum(ROTATE_PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Rotate: two simulated planar arms of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, ROTATE_PARTS_MM)
    losses, *panels = parts[0].subplots(1, 1 + len(near), squeeze=False)[0]
    draw_losses(losses, rows, motion.name)
    for place, (axes, model) in enumerate(zip(panels, near, strict=False)):
        draw_over_z(axes, rows, motion.name, model.model, _turn_deg(motion, model, three))
        title(axes, f"{model.look.label}, turn", "" if place else "B")
        axes.set_ylabel(f"turned in {ROTATE_HOLD_S:g} s (deg)")
    for place, axes in enumerate(row_of_panels(parts[1], 3 * len(near))):
        model, state = near[place // 3], place % 3
        _draw_turns(axes, motion, model, three[state])
        title(axes, f"{model.look.label}, state {state + 1}")
        plane(axes, BOX_VIEW, ticks=3)
    start = spread_states(states, turn, 12)[0]
    for axes, model in zip(row_of_panels(parts[2], len(shown)), shown, strict=True):
        _draw_rotate_rollout(axes, motion, model, start)
        title(axes, f"{model.look.label}, z = +1", "C" if model is shown[0] else "")
        plane(axes, ROTATE_ROLLOUT_VIEW)
    return figure


def _turn_deg(motion: Rotate, model: Shown, states: FloatArray) -> FloatArray:
    """How far the grippers turn from each state, on average of the two, counterclockwise: (K, N), deg."""
    ends = model.hold(states, GRID[:, None], ROTATE_HOLD_S)[:, :, -1]
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


def _draw_turns(axes: "Axes", motion: Rotate, model: Shown, state: FloatArray) -> None:
    """The box in one state, and where z = -1 (pale) and z = +1 (dark) turn it."""
    ends = model.hold(state[None], np.array(ROTATE_POSES)[:, None], ROTATE_HOLD_S)[:, 0, -1]
    _draw_box(axes, motion, state, BOX_EDGE, BOX_COLOUR)
    draw_arm(axes, motion.robot, state)
    for z, pose in zip(ROTATE_POSES, ends, strict=True):
        draw_pose(axes, motion.robot, pose, shade(model.look.colour, z))
        _draw_box(axes, motion, pose, shade(model.look.colour, z))
    axes.plot(*_middle(motion, state), "+", color="black", markersize=6, zorder=7)


def _draw_rotate_rollout(axes: "Axes", motion: Rotate, model: Shown, start: FloatArray) -> None:
    """Both arms and the box while z = +1 is held: pale at first, then darker."""
    passed = model.hold(start[None], np.ones((1, 1)), ROTATE_ROLLOUT_S)[0, 0]
    _draw_box(axes, motion, start, BOX_EDGE, BOX_COLOUR)
    draw_arm(axes, motion.robot, start)
    every = round(ROTATE_BETWEEN_POSES_S / STEP_S)
    for moment in range(every, len(passed), every):
        colour = shade(model.look.colour, 2 * moment / (len(passed) - 1) - 1)
        draw_pose(axes, motion.robot, passed[moment], colour)
        _draw_box(axes, motion, passed[moment], colour)
    left, right = np.moveaxis(_grips(motion, passed), -2, 0)
    off = np.abs(np.linalg.norm(left - right, axis=-1) - BOX_WIDTH_M).max()
    note(axes, f"grip on the box off by up to {1000 * off:.0f} mm")


CIRCLE_PARTS_MM: Final = (52.0, 72.0)
CIRCLE_HOLD_S: Final = 0.25
AROUND: Final = 8
"""Places on each circle from which arrows are drawn."""
HALF_VIEW_M: Final = 0.21
SECOND_COLOUR: Final = "#8a8f96"
"""Of z_2, in all models; z_1 has the model's colour."""


def circle_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; angles between the axes; where z_1 and z_2 move the tool at places on two circles."""
    motion = Circle()
    starts = _around(motion, passed_states(motion))
    shown = as_trained(decoders, CONTRASTED)
    figure = new_figure(sum(CIRCLE_PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Circle: a simulated planar arm of 5 joints, 2-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, CIRCLE_PARTS_MM)
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


def _draw_arrows(axes: "Axes", motion: Circle, model: Shown, starts: FloatArray) -> None:
    """Where the tool gets from each start (dots) while one axis is held at +1 and the other at 0."""
    draw_guides(axes, motion)
    place = plane_point(motion.robot, starts)
    first, second = plane_point(motion.robot, model.hold(starts, np.eye(2), CIRCLE_HOLD_S)[:, :, -1])
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


REACH_PARTS_MM: Final = (52.0, 64.0)
REACH_HELD: Final = axis_grid(9)
REGION_COLOUR: Final = "#fdf3c4"
REACH_VIEW: Final = ((-0.45, 0.1), (-0.04, 0.46))


def reach_figure(decoders: Decoders, rows: Sequence[Row]) -> "Figure":
    """Losses; final distances; tool paths from one start while z is held, for nine values of z.

    Positive z leads upwards in all models.
    """
    motion = ReachRegion()
    states = passed_states(motion)
    shown = turned(decoders, CONTRASTED, states, lambda state: plane_point(motion.robot, state)[..., 1])
    figure = new_figure(sum(REACH_PARTS_MM), TWO_COLUMNS_MM)
    figure.suptitle("Reach: a simulated planar arm of 5 joints, 1-D latent action", fontsize=FONT_SIZE)
    parts = stacked_parts(figure, REACH_PARTS_MM)
    losses, distances = parts[0].subplots(1, 2)
    draw_losses(losses, rows, motion.name)
    final = in_mm(points(rows, motion.name, "final_distance"))
    draw_points(distances, final, log_axis(distances, final.values()))
    title(distances, "distance to the goal in the end", "B")
    distances.set_xlabel("mm")
    for axes, model in zip(row_of_panels(parts[1], len(shown)), shown, strict=True):
        _draw_reach_paths(axes, motion, model, _middle_start(motion, states))
        title(axes, f"{model.look.label}, z from −1 (pale) to +1", "C" if model is shown[0] else "")
        plane(axes, REACH_VIEW)
    return figure


def _middle_start(motion: ReachRegion, states: FloatArray) -> FloatArray:
    """A state (n,) at the middle of the start side."""
    (outline,) = motion.guides
    wanted = outline[:-1].mean(axis=0) - (DISTANCE_M, 0.0)
    return states[np.argmin(np.linalg.norm(plane_point(motion.robot, states) - wanted, axis=-1))]


def _draw_reach_paths(axes: "Axes", motion: ReachRegion, model: Shown, start: FloatArray) -> None:
    """The arm at the start, the goal region, and the tool's path for each value of z."""
    (outline,) = motion.guides
    axes.fill(*outline.T, facecolor=REGION_COLOUR, edgecolor="black", linewidth=0.8, zorder=1)
    paths = plane_point(motion.robot, model.hold(start[None], REACH_HELD[:, None], DURATION_S)[:, 0])
    draw_arm(axes, motion.robot, start)
    for z, path in zip(REACH_HELD, paths, strict=True):
        axes.plot(*path.T, color=shade(model.look.colour, z), linewidth=1.2, zorder=5)
        axes.plot(*path[-1], model.look.marker, color=shade(model.look.colour, z), markersize=3.0, zorder=5.5)


TASK_FIGURES: Final[dict[str, Callable[[Decoders, Sequence[Row]], "Figure"]]] = {
    "sine": sine_figure,
    "rotate": rotate_figure,
    "circle": circle_figure,
    "reach": reach_figure,
}
"""The figure of each task."""
