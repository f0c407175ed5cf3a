"""Figure: our figures beside the paper's, wherever the paper prints one that can be compared."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.studies.panels import title
from latentarm.studies.properties.figures.dots import draw_paper, draw_spread, log_axis
from latentarm.studies.properties.figures.panels import Point, points
from latentarm.studies.properties.tables import OURS
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, look_of, new_figure, tidy
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COMPARED: Final = (
    ("sine", "error_percent_of_pca", "loss (% of PCA)"),
    ("sine", "controllability_percent_of_pca", "distance to goal (% of PCA)"),
    ("sine", "r2", "$R^2$"),
    ("rotate", "error_percent_of_pca", "loss (% of PCA)"),
    ("rotate", "controllability_percent_of_pca", "distance to goal (% of PCA)"),
    ("rotate", "r2", "$R^2$ of turning"),
    ("circle", "disentanglement_deg", "angle of the axes (deg)"),
    ("reach", "final_distance_percent_of_vae", "final distance (% of VAE)"),
    ("reach", "path_length_percent_of_vae", "path length (% of VAE)"),
)
"""Task, measure and what the axis says. Lengths are compared as ratios: the paper states no unit."""

ACROSS: Final = 3
LINE_MM: Final = 5.0
APART: Final = 0.2
"""Of ours and the paper's from the line of their model."""
FRAME_MM: Final = 17.0


def beside_paper_figure(rows: Sequence[Row], tasks: Sequence[str]) -> "Figure":
    """One panel per task and measure: ours filled, the paper's hollow; models that the paper has, and ours.

    Args:
        rows: of the study, with the paper's figures.
        tasks: those that were run.
    """
    compared = [(task, measure, label) for task, measure, label in COMPARED if task in tasks]
    found = [points(rows, task, measure) for task, measure, _ in compared]
    printed = {model for figures in found for model, figure in figures.items() if figure.paper is not None}
    models = [
        model for model in dict.fromkeys(m for figures in found for m in figures) if model in {*printed, OURS}
    ]
    down = -(-len(compared) // ACROSS)
    figure = new_figure(down * (FRAME_MM + LINE_MM * max(len(models), 2)) + 8.0, TWO_COLUMNS_MM)
    figure.suptitle(
        "The paper's simulations (hollow) and ours (filled), mean ± SD over seeds; all arms simulated",
        fontsize=FONT_SIZE,
    )
    panels = figure.subplots(down, ACROSS, sharey=True, squeeze=False)
    for axes, (task, measure, label), figures in zip(panels.flat, compared, found, strict=False):
        _draw_measure(axes, {model: figures[model] for model in models if model in figures}, models, measure)
        title(axes, task.capitalize())
        axes.set_xlabel(label)
        axes.set_yticks(range(len(models)), [look_of(model).label for model in models])
        axes.set_ylim(len(models) - 0.4, -0.6)
        tidy(axes)
    for axes in panels.flat[len(compared) :]:
        axes.remove()
    return figure


def _draw_measure(axes: "Axes", figures: dict[str, Point], models: Sequence[str], measure: str) -> None:
    """Ours above the line of the model, the paper's below it."""
    left = log_axis(axes, figures.values()) if measure.endswith("_percent_of_pca") else 0.0
    for model, figure in figures.items():
        place = models.index(model)
        look = look_of(model)
        draw_spread(axes, place - APART, figure.mean, figure.sd, left)
        axes.plot(figure.mean, place - APART, look.marker, color=look.colour, markersize=5.5, zorder=7)
        draw_paper(axes, place + APART, figure, left)
