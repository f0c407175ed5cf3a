"""All figures of the study, from its results."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.studies.properties.cell import CellResult
from latentarm.studies.properties.figures.beside_paper import beside_paper_figure
from latentarm.studies.properties.figures.circle import circle_figure
from latentarm.studies.properties.figures.controllability import controllability_figure
from latentarm.studies.properties.figures.noise import noise_figure
from latentarm.studies.properties.figures.reach import reach_figure
from latentarm.studies.properties.figures.rotate import rotate_figure
from latentarm.studies.properties.figures.shown import Decoders
from latentarm.studies.properties.figures.sine import sine_figure
from latentarm.style import save_figure
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TASK_FIGURES: Final[dict[str, Callable[[Decoders, Sequence[Row]], "Figure"]]] = {
    "sine": sine_figure,
    "rotate": rotate_figure,
    "circle": circle_figure,
    "reach": reach_figure,
}

FIGURES: Final = ("beside_paper", "controllability", "noise", *TASK_FIGURES)
"""Names of all files that `draw_figures` may write, without ``.png``."""


def draw_figures(results: Sequence[CellResult], rows: Sequence[Row], out: Path) -> list[Path]:
    """Write a PNG per task, and those over all tasks: noise, controllability, the paper beside ours.

    Args:
        results: every cell of the study.
        rows: the study's figures, with the paper's.
        out: the folder to write to.

    Returns:
        The files, those over all tasks first.

    Raises:
        UserError: a file cannot be written.
    """
    tasks = list(dict.fromkeys(result.cell.task for result in results))
    noises_rad = sorted({result.cell.noise_rad for result in results})
    figures = {
        "beside_paper": beside_paper_figure(rows, tasks),
        "controllability": controllability_figure(rows, tasks),
    }
    if len(noises_rad) > 1:
        figures["noise"] = noise_figure(rows, tasks, noises_rad)
    for task in tasks:
        decoders = {
            result.cell.model: result.decoder
            for result in results
            if result.cell.task == task and result.cell.noise_rad == 0.0
        }
        figures[task] = TASK_FIGURES[task](decoders, rows)
    paths = [out / f"{name}.png" for name in figures]
    for path, figure in zip(paths, figures.values(), strict=True):
        save_figure(figure, path)
    return paths
