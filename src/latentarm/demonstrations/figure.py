"""The figure of ``inspect``: every joint of every episode over time, between its limits."""

import math
from pathlib import Path
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from latentarm.core.figure_style import FIGURE_DPI, literal, tidy
from latentarm.core.files import written_whole
from latentarm.core.types import Demonstrations
from latentarm.robots.limits import JointLimits

LINE: Final = "#0072B2"
LIMIT: Final = "#D55E00"
WIDTH_INCH: Final = 7.0
ROW_INCH: Final = 1.5
COLUMNS: Final = 2


def draw_trajectories(demonstrations: Demonstrations, path: Path, limits: JointLimits | None = None) -> None:
    """Draw the joints' positions over time to a PNG file, and shade the region beyond the limits."""
    dof = demonstrations.dof
    rows = math.ceil(dof / COLUMNS)
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = Figure(figsize=(WIDTH_INCH, 0.9 + ROW_INCH * rows), layout="constrained", dpi=FIGURE_DPI)
        FigureCanvasAgg(figure)
        grid = figure.subplots(rows, COLUMNS, sharex=True, squeeze=False)
        for joint, axes in enumerate(grid.ravel()):
            if joint < dof:
                _draw_joint(axes, demonstrations, joint, limits)
            else:
                axes.set_axis_off()
        for column in range(min(COLUMNS, dof)):
            lowest = grid[(dof - 1 - column) // COLUMNS, column]
            lowest.tick_params(labelbottom=True)
            lowest.set_xlabel("time from the episode's start (s)")
        figure.supylabel("joint position (rad)", fontsize=9)
        figure.legend(
            handles=_key(limits is not None), loc="outside lower center", ncols=3, frameon=False, fontsize=8
        )
        figure.suptitle(_title(demonstrations), fontsize=10)
        with written_whole(path) as part:
            figure.savefig(part, format="png")


def _title(demonstrations: Demonstrations) -> str:
    samples = sum(len(episode.timestamp) for episode in demonstrations.episodes)
    robot = f"{literal(Path(demonstrations.robot).stem)}: " if demonstrations.robot else ""
    episodes = len(demonstrations.episodes)
    counted = "1 episode" if episodes == 1 else f"{episodes} episodes"
    return f"{robot}{counted}, {samples:,} samples at {demonstrations.rate_hz:g} Hz"


def _key(limited: bool) -> list[Artist]:
    episode = Line2D([], [], color=LINE, linewidth=0.9, label="one episode")
    limit = Line2D([], [], color=LIMIT, linewidth=1.0, linestyle="--", label="joint limit")
    beyond = Patch(color=LIMIT, alpha=0.15, linewidth=0, label="out of reach")
    return [episode, limit, beyond] if limited else [episode]


def _draw_joint(axes: Axes, demonstrations: Demonstrations, joint: int, limits: JointLimits | None) -> None:
    tidy(axes)
    alpha = max(0.25, min(1.0, 4.0 / len(demonstrations.episodes)))
    for episode in demonstrations.episodes:
        time = episode.timestamp - episode.timestamp[0]
        axes.plot(time, episode.state[:, joint], color=LINE, alpha=alpha, linewidth=0.9)
    axes.set_title(literal(demonstrations.joint_names[joint]), loc="left", pad=3)
    if limits is None:
        return
    lower, upper = float(limits.lower[joint]), float(limits.upper[joint])
    states = np.concatenate([episode.state[:, joint] for episode in demonstrations.episodes])
    margin = 0.08 * (upper - lower)
    bottom = min(lower - margin, float(states.min()) - margin)
    top = max(upper + margin, float(states.max()) + margin)
    for edge, beyond in ((lower, bottom), (upper, top)):
        axes.axhspan(edge, beyond, color=LIMIT, alpha=0.15, linewidth=0)
        axes.axhline(edge, color=LIMIT, linewidth=1.0, linestyle="--")
    axes.set_ylim(bottom, top)
