"""Figure: people of fixed expertise, as in the paper's figure 9."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.studies.panels import title
from latentarm.studies.shared_autonomy.cell import CellResult
from latentarm.studies.shared_autonomy.figures.series import draw_over, name_methods, outcomes_of
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.studies.shared_autonomy.people import of_fixed_expertise
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.style import FONT_SIZE, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEIGHT_MM: Final = 88.0
MEASURES: Final = {"final_state_error": "final state error", "time_s": "time to the goal (s)"}
NAMES: Final = {1000.0: "$10^3$", 10000.0: "$10^4$"}
"""Numbers that would be too long for an axis."""


def expertise_figure(results: Sequence[CellResult], preset: Preset, tasks: Sequence[str]) -> "Figure":
    """Final error and time over rationality, a column per arm.

    Args:
        results: every cell.
        preset: for the rationalities.
        tasks: those that were run.
    """
    figure = new_figure(HEIGHT_MM)
    figure.suptitle("Fixed expertise, mean with 95 % interval; simulated", fontsize=FONT_SIZE)
    panels = figure.subplots(len(MEASURES), len(tasks), sharex=True, sharey="row", squeeze=False)
    people = [of_fixed_expertise(beta).label for beta in preset.betas]
    for column, task in zip(panels.T, tasks, strict=True):
        outcomes = outcomes_of(results, task, MODEL)
        title(column[0], look_of(task).label)
        for axes, measure in zip(column, MEASURES, strict=True):
            draw_over(axes, outcomes, people, measure)
            axes.set_ylim(bottom=0.0)
            tidy(axes)
        column[-1].set_xlabel("rationality β (1/m²)", fontsize=FONT_SIZE)
        named = np.arange(0, len(people), 1 if len(people) < 5 else 2)
        names = [NAMES.get(preset.betas[place], f"{preset.betas[place]:g}") for place in named]
        column[-1].set_xticks(named, names)
    for axes, name in zip(panels[:, 0], MEASURES.values(), strict=True):
        axes.set_ylabel(name, fontsize=FONT_SIZE)
    name_methods(figure, panels[0, 0])
    return figure
