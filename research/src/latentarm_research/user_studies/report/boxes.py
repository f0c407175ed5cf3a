"""Box plots of people's means, and what each person took."""

from collections.abc import Collection, Sequence
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
from latentarm.evaluation.measures import unit_of
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.record import Trial

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ABOUT: Final = "#0072B2"
"""Of the condition that the first claim of a study is about, or of its last one."""

OTHERS: Final = ("#7f7f7f", "#E69F00", "#56B4E9", "#CC79A7", "#009E73", "#D55E00", "#F0E442")
"""Of the other ones in order; grey, and the Okabe-Ito palette."""

MOST_CONDITIONS: Final = len(OTHERS) + 1  # that colours tell apart


def colours(definition: Definition) -> dict[str, str]:
    """The colour of each condition."""
    names = [condition.name for condition in definition.conditions]
    subject = next((claim.subject[-1] for claim in definition.claims), names[-1])
    others = iter(OTHERS)
    return {name: ABOUT if name == subject else next(others) for name in names}


WHISKERS: Final = (10.0, 90.0)  # percentiles at the ends of a box's whiskers, as in the paper
ACROSS: Final = 3  # panels in a row
ROW_MM: Final = 52.0
LEGEND_MM: Final = 9.0


def box_figure(
    definition: Definition, trials: Sequence[Trial], measures: Sequence[str], who: str
) -> "Figure":
    """A panel for each measure; in it the tasks side by side, and a box for each condition."""
    from matplotlib.patches import Patch

    rows = -(-len(measures) // ACROSS)
    figure = new_figure(ROW_MM * rows + LEGEND_MM, TWO_COLUMNS_MM)
    panels = figure.subplots(rows, min(ACROSS, len(measures)), squeeze=False).ravel()
    for axes, measure in zip(panels, measures, strict=False):
        _boxes(axes, definition, trials, measure)
    for axes in panels[len(measures) :]:
        axes.set_visible(False)
    looks = colours(definition)
    names = [one.name for one in definition.conditions]
    handles = [Patch(facecolor=looks[name], edgecolor="black", linewidth=0.6) for name in names]
    heading = f"{who}: dots are people's means; whiskers at 10 and 90 %"
    legend_below(figure, handles, [literal(name) for name in names], heading=heading)
    return figure


def _boxes(axes: "Axes", definition: Definition, trials: Sequence[Trial], measure: str) -> None:
    looks, count = colours(definition), len(definition.conditions)
    people = sorted({trial.person for trial in trials})
    done = {one.task for one in trials if measure in one.measures}
    with_figures = [task for task in definition.tasks if task.name in done]
    for block, task in enumerate(with_figures):
        for place, condition in enumerate(definition.conditions):
            means = _of_each(trials, people, measure, condition.name, task)
            means = means[np.isfinite(means)]
            if not len(means):
                continue
            at = block * (count + 1) + place
            drawn = axes.boxplot(
                [means],
                positions=[at],
                widths=0.7,
                whis=WHISKERS,
                showfliers=False,
                patch_artist=True,
                medianprops={"color": "black", "linewidth": 1.0},
                boxprops={"linewidth": 0.6},
                whiskerprops={"linewidth": 0.6},
                capprops={"linewidth": 0.6},
            )
            for box in drawn["boxes"]:
                box.set_facecolor(looks[condition.name])
                box.set_alpha(0.7)
            spread = np.linspace(-0.18, 0.18, len(means)) if len(means) > 1 else np.zeros(1)
            axes.plot(at + spread, means, "o", color="black", markersize=1.4, alpha=0.6)
    middles = [block * (count + 1) + (count - 1) / 2 for block in range(len(with_figures))]
    axes.set_xticks(middles, [task.label for task in with_figures])
    axes.set_xlim(-0.8, len(with_figures) * (count + 1) - 1.2)
    unit = unit_of(measure)
    axes.set_title(definition.label(measure) + ("" if unit == "1" else f" ({unit.replace(' ', '·')})"))
    tidy(axes)
    axes.grid(False, axis="x")


SHOWN: Final = ("time_s", "goal_error_m_s")  # what the paper shows of each person (section 10)
MOST_PEOPLE: Final = 24  # of whom bars can be told apart
PERSON_ROW_MM: Final = 38.0
PERSON_LEGEND_MM: Final = 9.0

ROOM: Final = 0.8  # of a person's bars together, of the distance to the next person's


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
    figure = new_figure(PERSON_ROW_MM * len(rows) + PERSON_LEGEND_MM, TWO_COLUMNS_MM)
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
