"""Figure: a change of mind with every model, and what the entropy does for each."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.studies.panels import title
from latentarm.studies.shared_autonomy.cell import CellResult
from latentarm.studies.shared_autonomy.figures.series import draw_over, name_methods, outcomes_of
from latentarm.studies.shared_autonomy.people import changing
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW_MM: Final = 44.0
FRAME_MM: Final = 14.0


def models_figure(results: Sequence[CellResult], preset: Preset, tasks: Sequence[str]) -> "Figure":
    """Final error over the time of the change, a row per arm and a column per model.

    Args:
        results: every cell.
        preset: for the times of change.
        tasks: those that were run.
    """
    figure = new_figure(ROW_MM * len(tasks) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "A change of mind with each model, mean with 95 % interval; people and arms simulated",
        fontsize=FONT_SIZE,
    )
    models = list(dict.fromkeys(result.cell.model for result in results))
    panels = figure.subplots(len(tasks), len(models), sharex=True, sharey=True, squeeze=False)
    people = [changing(after_s).label for after_s in preset.changes_s]
    for line, task in zip(panels, tasks, strict=True):
        for axes, model in zip(line, models, strict=True):
            outcomes = outcomes_of(results, task, model)
            draw_over(axes, outcomes, people, "final_state_error", np.array(preset.changes_s))
            title(axes, f"{look_of(model).label}, {look_of(task).label}")
            axes.set_ylim(bottom=0.0)
            tidy(axes)
        line[0].set_ylabel("final state error", fontsize=FONT_SIZE)
    for axes in panels[-1]:
        axes.set_xlabel("change after (s)", fontsize=FONT_SIZE)
    name_methods(figure, panels[0, 0])
    return figure
