"""All figures of the study, from its results."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.studies.shared_autonomy.cell import TASKS, CellResult
from latentarm.studies.shared_autonomy.figures.changes import changes_figure
from latentarm.studies.shared_autonomy.figures.expertise import expertise_figure
from latentarm.studies.shared_autonomy.figures.learners import learners_figure
from latentarm.studies.shared_autonomy.figures.models import models_figure
from latentarm.studies.shared_autonomy.figures.tasks import task_figure
from latentarm.studies.shared_autonomy.figures.weights import weights_figure
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.studies.shared_autonomy.rows import Figure
from latentarm.style import save_figure

FIGURES: Final = (
    "fixed_expertise",
    "change_of_mind",
    "learners",
    "models",
    "entropy_weight",
    *TASKS,
)
"""Names of all files that `draw_figures` may write, without ``.png``."""


def draw_figures(
    results: Sequence[CellResult], found: Sequence[Figure], preset: Preset, tasks: Sequence[str], out: Path
) -> None:
    """Write the PNGs.

    Args:
        results: every cell of the study.
        found: every figure in the other sense.
        preset: sizes of the study.
        tasks: those that were run.
        out: the folder to write to.

    Raises:
        UserError: a file cannot be written.
    """
    drawings = {
        "fixed_expertise": expertise_figure(results, preset, tasks),
        "change_of_mind": changes_figure(results, preset, tasks),
        "learners": learners_figure(results, preset, tasks),
        "models": models_figure(results, preset, tasks),
    }
    if preset.ablation is not None:
        person = preset.latest_change.label
        drawings["entropy_weight"] = weights_figure(found, preset.ablation, person, tasks)
    drawings |= {task: task_figure(TASKS[task]()) for task in tasks}
    for name, drawing in drawings.items():
        save_figure(drawing, out / f"{name}.png")
