"""The paper's figures next to ours, and what the figures of tasks draw of the rows."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

from latentarm.core.figure_style import SMALL_FONT_SIZE, tidy
from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure
from latentarm_research.studies.drawing import first_panels, panel_grid, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


OURS: Final = "isometric"  # the model that figures show beside the paper's


class Point(NamedTuple):
    """One model's figure, with the paper's."""

    mean: float  # over seeds
    sd: float  # over seeds, 0 where there is one seed
    paper: float | None  # the paper's mean, where it reports one
    paper_sd: float  # 0 where the paper reports none


def points(rows: Iterable[Row], task: str, measure: str) -> dict[str, Point]:
    """One measure by model."""
    return {
        row.model: Point(row.mean, row.sd or 0.0, row.paper_mean, row.paper_sd or 0.0)
        for row in rows
        if (row.task, row.measure) == (task, measure) and row.model is not None and row.mean is not None
    }


def in_mm(lengths: Mapping[str, Point]) -> dict[str, Point]:
    """Lengths in metres as millimetres, without the paper's, for which it states no unit."""
    return {model: Point(1000 * point.mean, 1000 * point.sd, None, 0.0) for model, point in lengths.items()}


BELOW: Final = 0.25  # how far the paper's figure stands below ours, so that no SD is taken for the other
DECADES: Final = 50.0  # ratio of a logarithmic axis' ends above which powers of ten are enough as labels
PAPER_SIGN: Final = "($\\diamond$: the paper)"


def log_axis(axes: "Axes", figures: Collection[Point]) -> float:
    """Make the x axis logarithmic, around all figures and the paper's, and return its left edge."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set_xscale("log")
    spans = [(figure.mean, figure.mean + figure.sd) for figure in figures]
    spans += [(figure.paper, figure.paper) for figure in figures if figure.paper is not None]
    left = 0.5 * min((low for low, _ in spans if low > 0), default=1.0)
    right = 1.6 * max((high for _, high in spans), default=1.0)
    axes.set_xlim(left, max(right, 2 * left))
    between = (1.0,) if right > DECADES * left else (1.0, 2.0, 5.0)
    axes.xaxis.set_major_locator(LogLocator(subs=between))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    return left


def draw_points(
    axes: "Axes",  # where to draw; its scale is already set
    figures: Mapping[str, Point],
    left: float,
) -> None:
    """Draw points with their SD, named on the left and with their figures on the right.

    An SD that reaches the left edge goes on beyond it, on a logarithmic axis as far as zero.
    Points and not bars, because a bar's length means nothing on a logarithmic axis.
    """
    for place, (model, figure) in enumerate(figures.items()):
        look = look_of(model)
        draw_spread(axes, place, figure.mean, figure.sd, left)
        axes.plot(figure.mean, place, look.marker, color=look.colour, markersize=5.5, zorder=7)
        draw_paper(axes, place + BELOW, figure, left)
        axes.text(
            1.02,
            place,
            format_figure(figure.mean, figure.sd),
            transform=axes.get_yaxis_transform(),
            fontsize=SMALL_FONT_SIZE,
            verticalalignment="center_baseline",
        )
    axes.set_yticks(range(len(figures)), [look_of(model).label for model in figures])
    axes.set_ylim(len(figures) - 0.4, -0.6)
    tidy(axes)
    axes.grid(False, axis="y")


def draw_spread(axes: "Axes", place: float, mean: float, sd: float, left: float) -> None:
    """One SD to either side of a mean, no further down than the left edge."""
    ends = [max(mean - sd, left), mean + sd]
    axes.plot(ends, [place, place], color="black", linewidth=0.9, zorder=4)


def draw_paper(axes: "Axes", place: float, figure: Point, left: float) -> None:
    """The paper's figure, where there is one: a hollow diamond with its SD."""
    if figure.paper is None:
        return
    draw_spread(axes, place, figure.paper, figure.paper_sd, left)
    axes.plot(figure.paper, place, "d", markersize=5.0, color="white", markeredgecolor="black", zorder=6)


def draw_losses(
    axes: "Axes",  # where to draw
    rows: Sequence[Row],  # of the study; those of other tasks and measures are passed over
    task: str,
) -> None:
    """Median test loss in percent of PCA's on a logarithmic axis, with the paper's."""
    losses = points(rows, task, "median_error_percent_of_pca")
    draw_points(axes, losses, log_axis(axes, losses.values()))
    title(axes, "median test loss, mean ± SD", "A")
    papers = f"   {PAPER_SIGN}" if any(one.paper is not None for one in losses.values()) else ""
    axes.set_xlabel(f"% of PCA's{papers}")


COMPARED: Final = (
    ("sine", "median_error_percent_of_pca", "loss (% of PCA)"),
    ("sine", "median_controllability_percent_of_pca", "distance to goal (% of PCA)"),
    ("sine", "r2", "$R^2$"),
    ("rotate", "median_error_percent_of_pca", "loss (% of PCA)"),
    ("rotate", "median_controllability_percent_of_pca", "distance to goal (% of PCA)"),
    ("rotate", "r2", "$R^2$ of turning"),
    ("circle", "disentanglement_deg", "angle of the axes (deg)"),
    ("reach", "final_distance_percent_of_vae", "final distance (% of VAE)"),
    ("reach", "path_length_percent_of_vae", "path length (% of VAE)"),
)
"""Task, measure and what the axis says. Lengths are compared as ratios: the paper states no unit."""

ACROSS: Final = 3
LINE_MM: Final = 5.0
APART: Final = 0.2  # of ours and the paper's from the line of their model
FRAME_MM: Final = 17.0


def beside_paper_figure(rows: Sequence[Row], tasks: Sequence[str]) -> "Figure":
    """One panel per task and measure: ours filled, the paper's hollow; the paper's models, and ours."""
    compared = [(task, measure, label) for task, measure, label in COMPARED if task in tasks]
    found = [points(rows, task, measure) for task, measure, _ in compared]
    printed = {model for figures in found for model, figure in figures.items() if figure.paper is not None}
    models = [
        model for model in dict.fromkeys(m for figures in found for m in figures) if model in {*printed, OURS}
    ]
    heading = "The paper's simulations (hollow) and ours (filled), mean ± SD over seeds; all arms simulated"
    size = -(-len(compared) // ACROSS), ACROSS, FRAME_MM + LINE_MM * max(len(models), 2), 8.0
    figure, panels = panel_grid(heading, *size, sharey=True)
    for axes, (task, measure, label), figures in zip(panels.flat, compared, found, strict=False):
        _draw_measure(axes, {model: figures[model] for model in models if model in figures}, models, measure)
        title(axes, task.capitalize())
        axes.set_xlabel(label)
        axes.set_yticks(range(len(models)), [look_of(model).label for model in models])
        axes.set_ylim(len(models) - 0.4, -0.6)
        tidy(axes)
    first_panels(panels, len(compared))
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
