"""All figures of the study, from its results."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.curves import CurveResult
from latentarm.studies.alignment.drives import DrivesResult
from latentarm.studies.alignment.figures.conditions import conditions_figure
from latentarm.studies.alignment.figures.curves import curves_figure
from latentarm.studies.alignment.figures.drives import draw_drive_paths
from latentarm.studies.alignment.targets import PAPER_MODEL
from latentarm.style import save_figure

FIGURES: Final = ("conditions", "conditions_other_models", "curves", "drives")
"""Names of all files that `draw_figures` may write, without ``.png``."""


def draw_figures(
    results: Sequence[CellResult], curves: Sequence[CurveResult], drives: Sequence[DrivesResult], out: Path
) -> None:
    """Write the PNGs of what was measured.

    Args:
        results: every cell of the table.
        curves: every curve.
        drives: one for each kind of model that was driven with.
        out: the folder to write to.

    Raises:
        UserError: a file cannot be written.
    """
    tasks = list(dict.fromkeys(result.cell.task for result in results))
    noises = list(dict.fromkeys(result.cell.noise for result in results))
    models = list(dict.fromkeys(result.cell.model for result in results))
    others = [model for model in models if model != PAPER_MODEL]
    if PAPER_MODEL in models:
        save_figure(conditions_figure(results, [PAPER_MODEL], tasks, noises), out / "conditions.png")
    if others:
        save_figure(conditions_figure(results, others, tasks, noises), out / "conditions_other_models.png")
    if curves:
        save_figure(curves_figure(curves, tasks), out / "curves.png")
    if drives:
        draw_drive_paths(drives, out / "drives.png")
