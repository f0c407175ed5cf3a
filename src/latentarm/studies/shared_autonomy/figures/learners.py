"""Figure: people who learn while they drive, as in the paper's figure 11."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.studies.panels import title
from latentarm.studies.shared_autonomy.cell import CellResult
from latentarm.studies.shared_autonomy.figures.series import draw_course, name_methods, outcomes_of
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.studies.shared_autonomy.people import learner
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW_MM: Final = 44.0
FRAME_MM: Final = 14.0
COURSES: Final = {"error": "state error", "belief": "belief in the true goal"}


def learners_figure(results: Sequence[CellResult], preset: Preset, tasks: Sequence[str]) -> "Figure":
    """State error and belief over time, a row per arm.

    Args:
        results: every cell.
        preset: for the learners.
        tasks: those that were run.
    """
    figure = new_figure(ROW_MM * len(tasks) + FRAME_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "People who learn while they drive, β = m t, mean with 95 % interval; people and arms simulated",
        fontsize=FONT_SIZE,
    )
    columns = [(what, name) for what in COURSES for name in preset.learners]
    panels = figure.subplots(len(tasks), len(columns), sharex=True, squeeze=False)
    for line, task in zip(panels, tasks, strict=True):
        outcomes = outcomes_of(results, task, MODEL)
        for axes, (what, name) in zip(line, columns, strict=True):
            draw_course(axes, outcomes, learner(name, preset.learners[name]).label, what)
            title(axes, f"{look_of(task).label}, {name}")
            axes.set_ylabel(COURSES[what], fontsize=FONT_SIZE)
            tidy(axes)
    for what in COURSES:
        places = [place for place, column in enumerate(columns) if column[0] == what]
        alike = list(panels[:, places].flat)
        top = max(axes.get_ylim()[1] for axes in alike) if what == "error" else 1.03
        for axes in alike:
            axes.set_ylim(0.0 if what == "error" else -0.03, top)
    for axes in panels[-1]:
        axes.set_xlabel("time (s)", fontsize=FONT_SIZE)
    name_methods(figure, panels[0, 0])
    return figure
