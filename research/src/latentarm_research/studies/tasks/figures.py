"""The study's figure: how many runs succeed, by task and person."""

from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import FONT_SIZE, SMALL_FONT_SIZE, tidy
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.drawing import first_panels, name_series, panel_grid, title
from latentarm_research.studies.tasks.rows import ByTask

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS: Final = 2  # panels in a row, at most
ROW_MM: Final = 62.0
FRAME_MM: Final = 24.0

UNAWARE: Final = "joints"  # the context that knows nothing of things: its markers are small
SPREAD: Final = 0.7  # the width in which the conditions of a task stand side by side, in tasks


def success_figure(by_task: ByTask) -> "Figure":
    """The share of the runs that succeeded: a panel per person, tasks across."""
    conditions = dict.fromkeys(one for runs in by_task.values() for one in runs if one.person is not None)
    people = list(dict.fromkeys(one.person for one in conditions))
    moves = list(dict.fromkeys(one.by(None) for one in conditions))
    places = np.linspace(-SPREAD / 2, SPREAD / 2, len(moves))
    across = min(ACROSS, len(people))
    size = -(-len(people) // across), across, ROW_MM, FRAME_MM
    heading = "Share of the runs that succeeded; people and arm simulated"
    figure, grid = panel_grid(heading, *size, sharey=True)
    panels = first_panels(grid, len(people))
    for index, (axes, person) in enumerate(zip(panels, people, strict=True)):
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
                markersize=2.6 if what.name == UNAWARE else 6.0 if what.beside else 4.2,
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
        axes.set_ylabel("" if index % across else "runs (%)", fontsize=FONT_SIZE)
        tidy(axes)
        axes.tick_params(axis="x", labelsize=SMALL_FONT_SIZE)
    name_series(figure, *panels)
    return figure
