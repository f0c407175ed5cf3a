"""How the tool points in each step of a task, compared with how the step needs it."""

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.style import SMALL_FONT_SIZE, TWO_COLUMNS_MM, legend_below, literal, new_figure, tidy
from latentarm.core.types import FloatArray
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.report.looks import colours
from latentarm_research.user_studies.trace import Trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW_MM: Final = 58.0
LEGEND_MM: Final = 9.0

SPREAD: Final = 0.6
"""How much of the room of a step its conditions take."""

NAME_LETTERS: Final = 12
"""Of a step's name in one line."""


def step_figure(definition: Definition, traces: Sequence[Trace], who: str) -> "Figure":
    """A panel for each task; in it people's means in each step, and the mean over those who came so far."""
    from matplotlib.lines import Line2D

    looks, conditions = colours(definition), definition.conditions
    tasks = [task for task in definition.tasks if steps_of(traces, task)]
    figure = new_figure(ROW_MM * len(tasks) + LEGEND_MM, TWO_COLUMNS_MM)
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
