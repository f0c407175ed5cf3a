"""Figure: people who change their mind, as in the paper's figure 10."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.studies.panels import title
from latentarm.studies.shared_autonomy.cell import CellResult
from latentarm.studies.shared_autonomy.figures.series import (
    draw_course,
    draw_over,
    name_methods,
    outcomes_of,
)
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.studies.shared_autonomy.people import changing
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW_MM: Final = 46.0
FRAME_MM: Final = 14.0


def changes_figure(results: Sequence[CellResult], preset: Preset, tasks: Sequence[str]) -> "Figure":
    """Final error over the time of the change; belief over time for two of them; a row per arm.

    Args:
        results: every cell.
        preset: for the times of change.
        tasks: those that were run.
    """
    figure = new_figure(ROW_MM * len(tasks) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "People who change their mind about the cup, mean with 95 % interval; people and arms simulated",
        fontsize=FONT_SIZE,
    )
    drawn = preset.drawn_changes_s
    panels = figure.subplots(len(tasks), 1 + len(drawn), sharex="col", squeeze=False)
    people = [changing(after_s).label for after_s in preset.changes_s]
    for (error, *beliefs), task in zip(panels, tasks, strict=True):
        outcomes = outcomes_of(results, task, MODEL)
        draw_over(error, outcomes, people, "final_state_error", np.array(preset.changes_s))
        title(error, look_of(task).label)
        error.set_ylim(bottom=0.0)
        error.set_ylabel("final state error", fontsize=FONT_SIZE)
        for axes, after_s in zip(beliefs, drawn, strict=True):
            draw_course(axes, outcomes, changing(after_s).label, "belief")
            axes.axvline(after_s, color="black", linestyle=":", linewidth=1.0, label="change of mind")
            title(axes, f"change after {after_s:g} s")
            axes.set_ylim(-0.03, 1.03)
            axes.set_ylabel("belief in the true goal", fontsize=FONT_SIZE)
        for axes in (error, *beliefs):
            tidy(axes)
    panels[-1, 0].set_xlabel("change after (s)", fontsize=FONT_SIZE)
    for axes in panels[-1, 1:]:
        axes.set_xlabel("time (s)", fontsize=FONT_SIZE)
    name_methods(figure, *panels[0])
    return figure
