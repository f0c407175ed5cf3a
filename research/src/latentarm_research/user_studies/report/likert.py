"""Diverging bars of answers, as in the paper's Likert figures, and how the tool points in each step."""

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import (
    SMALL_FONT_SIZE,
    TWO_COLUMNS_MM,
    legend_below,
    literal,
    new_figure,
    tidy,
)
from latentarm.core.types import FloatArray
from latentarm_research.user_studies.answers.scales import Rated
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.report.boxes import colours
from latentarm_research.user_studies.trace import Trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS: Final = 2  # panels in a row
BAR_MM: Final = 5.5
PANEL_MM: Final = 17.0
LEGEND_MM: Final = 12.0


def likert_figure(
    definition: Definition,
    rated: Sequence[Rated],  # every scale in every condition; reversed items are turned
    who: str,
) -> "Figure":
    """A panel for each scale without sliders; in it a bar for each condition, agreement to the right."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex
    from matplotlib.patches import Patch

    scales = [scale for scale in definition.questionnaire if not scale.slider]
    conditions = definition.conditions
    rows = -(-len(scales) // ACROSS)
    figure = new_figure(rows * (PANEL_MM + BAR_MM * len(conditions)) + LEGEND_MM, TWO_COLUMNS_MM)
    panels = figure.subplots(rows, min(ACROSS, len(scales)), squeeze=False, sharex=True).ravel()
    most = max(scale.points for scale in scales)
    for axes, scale in zip(panels, scales, strict=False):
        looks = colormaps["PuOr"](np.linspace(0.1, 0.9, scale.points))
        for place, condition in enumerate(conditions):
            one = next(one for one in rated if (one.scale, one.condition) == (scale.name, condition.name))
            shares = 100.0 * np.array(one.counts) / max(sum(one.counts), 1)
            lower = scale.points // 2
            # Half of the neutral answers stand on either side of 0.
            neutral = shares[lower] / 2.0 if scale.points % 2 else 0.0
            left = -shares[:lower].sum() - neutral
            for share, look in zip(shares, looks, strict=True):
                axes.barh(place, share, left=left, color=look, height=0.7)
                left += share
        axes.set_yticks(range(len(conditions)), [literal(one.name) for one in conditions])
        axes.invert_yaxis()
        axes.set_xlim(-100.0, 100.0)
        axes.set_xticks((-100, -50, 0, 50, 100), ("100", "50", "0", "50", "100"))
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set_title(literal(scale.label))
        tidy(axes)
        axes.grid(False, axis="y")
        axes.tick_params(labelsize=SMALL_FONT_SIZE)
    for axes in panels[len(scales) :]:
        axes.set_visible(False)
    for axes in panels[max(len(scales) - ACROSS, 0) : len(scales)]:
        axes.set_xlabel("answers (%)")
        axes.tick_params(labelbottom=True)
    colours = colormaps["PuOr"](np.linspace(0.1, 0.9, most))
    handles = [Patch(facecolor=to_hex(colour)) for colour in colours]
    points = [str(point) for point in range(1, most + 1)]
    ends = {f"1 {scale.low}, {scale.points} {scale.high}" for scale in scales}
    points_words = literal(ends.pop()) if len(ends) == 1 else "from 1 on"
    heading = f"{who}: {points_words}; reversed items turned"
    legend_below(figure, handles, points, heading=heading)
    return figure


STEPS_ROW_MM: Final = 58.0
STEPS_LEGEND_MM: Final = 9.0

SPREAD: Final = 0.6  # how much of the room of a step its conditions take
NAME_LETTERS: Final = 12  # of a step's name in one line


def step_figure(definition: Definition, traces: Sequence[Trace], who: str) -> "Figure":
    """A panel for each task; in it people's means in each step, and the mean over those who came so far."""
    from matplotlib.lines import Line2D

    looks, conditions = colours(definition), definition.conditions
    tasks = [task for task in definition.tasks if steps_of(traces, task)]
    figure = new_figure(STEPS_ROW_MM * len(tasks) + STEPS_LEGEND_MM, TWO_COLUMNS_MM)
    panels = figure.subplots(len(tasks), 1, squeeze=False).ravel()
    for axes, task in zip(panels, tasks, strict=True):
        steps = steps_of(traces, task)
        for place, condition in enumerate(conditions):
            aside = SPREAD * (place / max(len(conditions) - 1, 1) - 0.5)
            means = [people_in(traces, task, condition.name, step) for step in steps]
            at = [index + aside for index, here in enumerate(means) if len(here)]
            colour = looks[condition.name]
            for x, here in zip(at, (one for one in means if len(one)), strict=True):
                axes.plot(np.full(len(here), x), here, "o", color=colour, markersize=2.0, alpha=0.6)
            axes.plot(at, [here.mean() for here in means if len(here)], "-", color=colour, linewidth=1.2)
        axes.set_xticks(
            range(len(steps)), [fill(literal(step), NAME_LETTERS) for step in steps], fontsize=SMALL_FONT_SIZE
        )
        axes.set_title(task.label)
        axes.set_ylabel("preference alignment")
        tidy(axes)
        axes.grid(False, axis="x")
    handles = [Line2D([], [], color=looks[one.name], marker="o", markersize=2.0) for one in conditions]
    legend_below(
        figure,
        handles,
        [literal(one.name) for one in conditions],
        heading=f"{who}: 1 is exactly as it is needed",
    )
    return figure


def steps_of(traces: Sequence[Trace], task: StudyTask) -> list[str]:
    """The steps of a task that anybody began, in the order of the drive that came farthest."""
    farthest = max((trace.aligned for trace in traces if trace.task == task.name), key=len, default=())
    return [one.step for one in farthest]


def people_in(traces: Sequence[Trace], task: StudyTask, condition: str, step: str) -> FloatArray:
    """(n,), mean of each person who began a step, over the time that they spent at it."""
    values: dict[int, list[float]] = {}
    weights: dict[int, list[int]] = {}
    for trace in traces:
        for one in trace.aligned:
            if (trace.task, trace.condition, one.step) == (task.name, condition, step):
                values.setdefault(trace.person, []).append(one.alignment)
                weights.setdefault(trace.person, []).append(one.ticks)
    return np.array([np.average(values[person], weights=weights[person]) for person in values])
