"""Figure: what noise on the states does to each model's loss, on every task."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.studies.panels import title
from latentarm.studies.properties.figures.panels import points
from latentarm.style import FONT_SIZE, TWO_COLUMNS_MM, legend_below, look_of, new_figure, tidy
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT_MM: Final = 98.0
MEASURES: Final = {
    "error_percent_of_pca": "noisy states",
    "noise_free_error_percent_of_pca": "noise-free states",
}
"""What the models are tested on; they are trained on noisy states in both."""


def condition(noise_rad: float) -> str:
    """How rows name a noise."""
    return f"noise {noise_rad:g} rad"


def noise_figure(rows: Sequence[Row], tasks: Sequence[str], noises_rad: Sequence[float]) -> "Figure":
    """Loss over noise, a line per model; tested with the noise (above) and without it (below).

    Args:
        rows: of the study.
        tasks: those that were run.
        noises_rad: SDs of the noise on states, rad, rising.
    """
    figure = new_figure(HEIGHT_MM, TWO_COLUMNS_MM)
    figure.suptitle(
        "Models trained with noise on the joint positions of simulated arms, mean ± SD over seeds",
        fontsize=FONT_SIZE,
    )
    panels = figure.subplots(len(MEASURES), len(tasks), sharex=True, sharey=True, squeeze=False)
    for line, (measure, where) in zip(panels, MEASURES.items(), strict=True):
        for axes, task in zip(line, tasks, strict=True):
            _draw_sweep(axes, rows, task, measure, noises_rad)
            tidy(axes)
        line[0].set_ylabel(f"loss on {where}\n(% of PCA)", fontsize=FONT_SIZE)
    lowest = min((row.mean for row in rows if row.measure in MEASURES and row.mean), default=1.0)
    panels[0, 0].set_ylim(bottom=lowest / 2.0)
    for axes, task in zip(panels[0], tasks, strict=True):
        title(axes, task.capitalize())
    for axes in panels[-1]:
        axes.set_xlabel("noise (rad)", fontsize=FONT_SIZE)
        axes.set_xticks(range(len(noises_rad)), [f"{noise:g}" for noise in noises_rad])
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend_below(figure, handles, labels, handle_length=4.0)
    return figure


def _draw_sweep(
    axes: "Axes", rows: Sequence[Row], task: str, measure: str, noises_rad: Sequence[float]
) -> None:
    """One line per model; series stand a little apart, for their bars not to hide each other."""
    sweep = [points(rows, task, measure, condition(noise)) for noise in noises_rad]
    models = list(dict.fromkeys(model for figures in sweep for model in figures))
    for index, model in enumerate(models):
        look = look_of(model)
        shift = 0.03 * (index - (len(models) - 1) / 2)
        known = [(place, figures[model]) for place, figures in enumerate(sweep) if model in figures]
        axes.errorbar(
            [place + shift for place, _ in known],
            [figure.mean for _, figure in known],
            yerr=[figure.sd for _, figure in known],
            color=look.colour,
            marker=look.marker,
            linestyle=look.dash,
            markersize=4.5,
            linewidth=1.1,
            elinewidth=0.8,
            label=look.label,
        )
    # An SD that reaches zero leaves the panel at its foot.
    axes.set_yscale("log", nonpositive="clip")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
