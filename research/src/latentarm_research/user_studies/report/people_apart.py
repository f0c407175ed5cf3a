"""What each person took and missed, separately."""

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.style import SMALL_FONT_SIZE, TWO_COLUMNS_MM, legend_below, literal, new_figure, tidy
from latentarm.core.types import FloatArray
from latentarm.evaluation.measures import unit_of
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.report.looks import colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHOWN: Final = ("time_s", "goal_error_m_s")
"""What the paper shows of each person (section 10)."""

MOST_PEOPLE: Final = 24
"""Of whom bars can be told apart."""

ROW_MM: Final = 38.0
LEGEND_MM: Final = 9.0

ROOM: Final = 0.8
"""Of a person's bars together, of the distance to the next person's."""


def people_measures(measured: Collection[str]) -> list[str]:
    """Those of a study's measures that are shown of each person."""
    return [name for name in SHOWN if name in measured]


def people_figure(
    definition: Definition, trials: Sequence[Trial], measures: Sequence[str], who: str
) -> "Figure":
    """A row for each task and measure; in it each person's bars, one for each condition."""
    from matplotlib.patches import Patch

    rows = [
        (task, measure)
        for task in definition.tasks
        for measure in measures
        if any(one.task == task.name and measure in one.measures for one in trials)
    ]
    figure = new_figure(ROW_MM * len(rows) + LEGEND_MM, TWO_COLUMNS_MM)
    people = sorted({trial.person for trial in trials})
    panels = figure.subplots(len(rows), 1, squeeze=False).ravel()
    for axes, (task, measure) in zip(panels, rows, strict=True):
        _bars(axes, definition, trials, people, task, measure)
    panels[-1].set_xlabel("person")
    looks = colours(definition)
    names = [one.name for one in definition.conditions]
    handles = [Patch(facecolor=looks[name]) for name in names]
    legend_below(figure, handles, [literal(name) for name in names], heading=f"{who}: one group of bars each")
    return figure


def _bars(
    axes: "Axes",
    definition: Definition,
    trials: Sequence[Trial],
    people: Sequence[int],
    task: StudyTask,
    measure: str,
) -> None:
    looks, conditions = colours(definition), definition.conditions
    width, at = ROOM / len(conditions), np.arange(len(people))
    for place, condition in enumerate(conditions):
        x = at + width * (place - (len(conditions) - 1) / 2.0)
        total = _of_each(trials, people, measure, condition.name, task)
        idle = np.zeros(len(people))
        if measure == "time_s":
            idle = np.nan_to_num(_of_each(trials, people, "idle_s", condition.name, task))
        colour = looks[condition.name]
        axes.bar(x, total - idle, width, color=colour)
        axes.bar(x, idle, width, bottom=total - idle, color=colour, alpha=0.35)
    axes.set_xticks(at, [str(person + 1) for person in people], fontsize=SMALL_FONT_SIZE)
    axes.set_ylabel(f"{definition.label(measure)} ({unit_of(measure).replace(' ', '·')})")
    axes.set_title(task.label)
    tidy(axes)
    axes.grid(False, axis="x")


def _of_each(
    trials: Sequence[Trial], people: Sequence[int], measure: str, condition: str, task: StudyTask
) -> FloatArray:
    return np.array([person_mean(trials, one, measure, (condition,), (task.name,)) for one in people])
