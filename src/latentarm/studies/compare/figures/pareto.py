"""Figure: what accuracy costs, error against reversal and against greedy reach, a point per model."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.metrics.looks import look_of
from latentarm.studies.compare.figures.scale import logarithmic_with_zero
from latentarm.studies.compare.rows import condition
from latentarm.studies.drawing import title
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, literal, new_figure, tidy
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT_MM: Final = 120.0
FILLS: Final = ("full", "none", "bottom", "top", "left", "right")
"""Of the markers, by noise."""

AGAINST: Final = {
    "reversal": ("left after z, then −z (%)", 100.0),
    "controllability_m": ("greedy reach (mm)", 1e3),
}
"""Measure -> its axis' label, and what it is multiplied by."""


def pareto_figure(rows: Sequence[Row], datasets: Sequence[str], noises_rad: Sequence[float]) -> "Figure":
    """Best is at the lower left.

    Args:
        rows: see `rows_of`.
        datasets: names, a column each.
        noises_rad: rad; the first is filled, the second open.
    """
    figure = new_figure(HEIGHT_MM, TWO_COLUMNS_MM)
    said = ", ".join(
        f"{fill} {noise_rad:g} rad"
        for noise_rad, fill in zip(noises_rad, ("filled:", "open:", *("further:",) * 4), strict=False)
    )
    figure.suptitle(
        f"Models on held-out episodes, mean ± SD over seeds; noise on states, {said}", fontsize=FONT_SIZE
    )
    panels = figure.subplots(len(AGAINST), len(datasets), sharex="col", sharey="row", squeeze=False)
    for line, measure in zip(panels, AGAINST, strict=True):
        for axes, dataset in zip(line, datasets, strict=True):
            for noise_rad, fill in zip(noises_rad, FILLS, strict=False):
                _draw(axes, rows, dataset, noise_rad, measure, fill)
            tidy(axes)
        line[0].set_ylabel(AGAINST[measure][0], fontsize=FONT_SIZE)
        logarithmic_with_zero(line[0])
    for axes, dataset in zip(panels[0], datasets, strict=True):
        title(axes, literal(dataset))
    for axes in panels[-1]:
        axes.set_xlabel("error (% of PCA's)", fontsize=FONT_SIZE)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, handles, labels)
    return figure


def _draw(axes: "Axes", rows: Sequence[Row], dataset: str, noise_rad: float, measure: str, fill: str) -> None:
    here = {
        (row.model or "", row.measure): row
        for row in rows
        if (row.task, row.condition) == (dataset, condition(noise_rad))
    }
    scale = AGAINST[measure][1]
    for model in dict.fromkeys(model for model, _ in here):
        error, other, look = here[model, "error_percent_of_pca"], here[model, measure], look_of(model)
        if error.mean is None or other.mean is None:
            continue
        axes.errorbar(
            error.mean,
            scale * other.mean,
            xerr=error.sd or 0.0,
            yerr=scale * (other.sd or 0.0),
            color=look.colour,
            marker=look.marker,
            fillstyle=fill,
            markersize=6.0,
            linewidth=0.0,
            elinewidth=0.8,
            label=look.label if fill == FILLS[0] else None,
        )
