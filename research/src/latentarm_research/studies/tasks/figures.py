"""The study's figure: how many runs succeed, by task and person."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.style import FONT_SIZE, SMALL_FONT_SIZE, TWO_COLUMNS_MM, new_figure, tidy
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.drawing import name_series, title
from latentarm_research.studies.tasks.condition import Condition
from latentarm_research.studies.tasks.runs import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS: Final = 2
"""Panels in a row, at most."""

ROW_MM: Final = 62.0
FRAME_MM: Final = 24.0

UNAWARE: Final = "joints"
"""The context that knows nothing of things: its markers are small."""

SPREAD: Final = 0.7
"""The width in which the conditions of a task stand side by side, in tasks."""


def success_figure(by_task: Mapping[str, Mapping[Condition, Sequence[Run]]]) -> "Figure":
    """The share of the runs that succeeded: a panel per person, tasks across."""
    conditions = dict.fromkeys(one for runs in by_task.values() for one in runs if one.person is not None)
    people = list(dict.fromkeys(one.person for one in conditions))
    moves = list(dict.fromkeys(one.by(None) for one in conditions))
    places = np.linspace(-SPREAD / 2, SPREAD / 2, len(moves))
    across = min(ACROSS, len(people))
    down = -(-len(people) // across)
    figure = new_figure(ROW_MM * down + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle("Share of the runs that succeeded; people and arm simulated", fontsize=FONT_SIZE)
    panels = np.ravel(figure.subplots(down, across, sharey=True, squeeze=False))
    for axes, person in zip(panels, people, strict=False):
        for what, place in zip(moves, places, strict=True):
            shares = {
                index + place: 100.0 * float(np.mean([run.success for run in runs[what.by(person)]]))
                for index, runs in enumerate(by_task.values())
                if what.by(person) in runs
            }
            look = look_of(what.model or what.name)
            axes.plot(
                list(shares),
                list(shares.values()),
                color=look.colour,
                marker=look.marker,
                markerfacecolor=look.colour if what.way_back else "white",
                markersize=2.6 if what.name == UNAWARE else 4.2,
                markeredgewidth=1.8 if what.way_back else 0.9,
                linestyle="none",
                label=what.label,
            )
        axes.set_xticks(
            range(len(by_task)),
            [look_of(task).label for task in by_task],
            rotation=40,
            ha="right",
            rotation_mode="anchor",
        )
        axes.set_xlim(-0.5, len(by_task) - 0.5)
        axes.set_ylim(-4.0, 104.0)
        title(axes, f"{person} person")
        axes.set_ylabel("runs (%)" if axes.get_subplotspec().is_first_col() else "", fontsize=FONT_SIZE)
        tidy(axes)
        axes.tick_params(axis="x", labelsize=SMALL_FONT_SIZE)
    for axes in panels[len(people) :]:
        axes.set_visible(False)
    name_series(figure, *panels[: len(people)])
    return figure
