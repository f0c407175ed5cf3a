"""The comparison's figures: error against reversal and reach, turning against both, fewer demonstrations."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from latentarm.core.figure_style import FONT_SIZE, legend_below, literal, tidy
from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.compare.tables import condition, with_demonstrations
from latentarm_research.studies.drawing import panel_grid, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


LINEAR_BELOW: Final = 1.0  # where the axis is linear, in its own unit

NUMBERS: Final = [0.0, *(digit * 10.0**power for power in range(4) for digit in (1, 2, 5))]
"""Those that may stand at the axis."""


def logarithmic_with_zero(axes: "Axes") -> None:
    """Scale the y axis about what is drawn; a marker at zero is shown whole."""
    axes.set_yscale("symlog", linthresh=LINEAR_BELOW, linscale=0.3)
    low, high = axes.get_ylim()
    low = -0.4 * LINEAR_BELOW if low <= 0 else 0.9 * low
    axes.set_yticks([number for number in NUMBERS if low <= number <= high], minor=False)
    axes.set_yticks([], minor=True)
    axes.set_ylim(low, 1.1 * high)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")


HEIGHT_MM: Final = 120.0
FILLS: Final = ("full", "none", "bottom", "top", "left", "right")  # of the markers, by noise


@dataclass(frozen=True)
class Axis:
    """How a measure is drawn."""

    measure: str  # its name
    label: str  # of the axis
    scale: float = 1.0  # what figures are multiplied by
    logarithmic: bool = False  # whether the scale is, with zero on it


ERROR: Final = Axis("search_error_percent_of_pca", "error (% of PCA's)")
REVERSAL: Final = Axis("reversal", "left after z, then −z (%)", 100.0, logarithmic=True)
REACH: Final = Axis("controllability_m", "greedy reach (mm)", 1e3, logarithmic=True)
TURNING: Final = Axis("motion_turn", "joints' turn per stick's")


def pareto_figure(
    rows: Sequence[Row],  # see `rows_of`
    datasets: Sequence[str],
    noises_rad: Sequence[float],  # rad; the first is filled, the second open
    across: Axis = ERROR,
    up: Sequence[Axis] = (REVERSAL, REACH),
) -> "Figure":
    """Models in two measures at a time, best at the lower left."""
    said = ", ".join(
        f"{fill} {noise_rad:g} rad"
        for noise_rad, fill in zip(noises_rad, ("filled:", "open:", *("further:",) * 4), strict=False)
    )
    heading = f"Models on held-out episodes, mean ± SD over seeds; noise on states, {said}"
    figure, panels = panel_grid(heading, len(up), len(datasets), 0.0, HEIGHT_MM, sharex="col", sharey="row")
    for line, axis in zip(panels, up, strict=True):
        for axes, dataset in zip(line, datasets, strict=True):
            for noise_rad, fill in zip(noises_rad, FILLS, strict=False):
                _draw_pareto(axes, rows, dataset, noise_rad, across, axis, fill)
            tidy(axes)
        line[0].set_ylabel(axis.label, fontsize=FONT_SIZE)
        if axis.logarithmic:
            logarithmic_with_zero(line[0])
    for axes, dataset in zip(panels[0], datasets, strict=True):
        title(axes, literal(dataset))
    for axes in panels[-1]:
        axes.set_xlabel(across.label, fontsize=FONT_SIZE)
    legend_below(figure, *panels[0, 0].get_legend_handles_labels())
    return figure


def turning_figure(rows: Sequence[Row], datasets: Sequence[str], noises_rad: Sequence[float]) -> "Figure":
    """Error and reach against how fast the motion turns; a model that turns with the stick is at 1."""
    return pareto_figure(rows, datasets, noises_rad, TURNING, (ERROR, REACH))


def _draw_pareto(
    axes: "Axes",
    rows: Sequence[Row],
    dataset: str,
    noise_rad: float,
    across: Axis,
    up: Axis,
    fill: str,
) -> None:
    here = {
        (row.model or "", row.measure): row
        for row in rows
        if (row.task, row.condition) == (dataset, condition(noise_rad))
    }
    for model in dict.fromkeys(model for model, _ in here):
        x, y, look = here[model, across.measure], here[model, up.measure], look_of(model)
        if x.mean is None or y.mean is None:
            continue
        axes.errorbar(
            across.scale * x.mean,
            up.scale * y.mean,
            xerr=across.scale * (x.sd or 0.0),
            yerr=up.scale * (y.sd or 0.0),
            color=look.colour,
            marker=look.marker,
            fillstyle=fill,
            markersize=6.0,
            linewidth=0.0,
            elinewidth=0.8,
            label=look.label if fill == FILLS[0] else None,
        )


LINE_MM: Final = 38.0
SPREAD: Final = 0.6  # width that the models share around a number of demonstrations; 1 reaches to the next
MEASURES: Final = {
    "search_error_percent_of_pca": ("error\n(% of PCA's)", 1.0),
    "search_noise_free_error_percent_of_pca": ("noise-free error\n(% of PCA's)", 1.0),
    "controllability_m": ("greedy reach\n(mm)", 1e3),
    "reversal": ("left after z, −z\n(%)", 100.0),
}
"""Measure -> its axis' label, and what it is multiplied by."""


def fewer_figure(
    rows: Sequence[Row], datasets: Sequence[str], noises_rad: Sequence[float], counts: Sequence[int]
) -> "Figure":
    """Measures over the number of training demonstrations, a column per dataset."""
    levels = ", ".join(f"{noise_rad:g} rad" for noise_rad in noises_rad)
    dashed = " (the latter open and dashed)" if len(noises_rad) > 1 else ""
    heading = f"Fewer training demonstrations, mean ± SD over seeds; noise on states {levels}{dashed}"
    size = len(MEASURES), len(datasets), LINE_MM, 20.0
    figure, panels = panel_grid(heading, *size, sharex=True, sharey="row")
    for line, (measure, (label, scale)) in zip(panels, MEASURES.items(), strict=True):
        for axes, dataset in zip(line, datasets, strict=True):
            _draw_fewer(axes, rows, dataset, noises_rad, counts, measure, scale)
            tidy(axes)
        line[0].set_ylabel(label, fontsize=FONT_SIZE)
        logarithmic_with_zero(line[0])
    for axes, dataset in zip(panels[0], datasets, strict=True):
        title(axes, literal(dataset))
    for axes in panels[-1]:
        axes.set_xlabel("training demonstrations", fontsize=FONT_SIZE)
        axes.set_xticks(range(len(counts)), [str(count) for count in counts])
    legend_below(figure, *panels[0, 0].get_legend_handles_labels())
    return figure


def _draw_fewer(
    axes: "Axes",
    rows: Sequence[Row],
    dataset: str,
    noises_rad: Sequence[float],
    counts: Sequence[int],
    measure: str,
    scale: float,
) -> None:
    """A line per model and noise; series are offset a little, so that their bars do not hide each other."""
    models = list(dict.fromkeys(row.model or "" for row in rows))
    for place, model in enumerate(models):
        look = look_of(model)
        for level, noise_rad in enumerate(noises_rad):
            known = [
                (at, row)
                for at, count in enumerate(counts)
                for row in rows
                if (row.task, row.model, row.measure) == (dataset, model, measure)
                and row.condition == condition(noise_rad, with_demonstrations(count))
            ]
            axes.errorbar(
                [at + SPREAD * ((place + 0.5) / len(models) - 0.5) for at, _ in known],
                [scale * (row.mean or 0.0) for _, row in known],
                yerr=[scale * (row.sd or 0.0) for _, row in known],
                color=look.colour,
                marker=look.marker,
                fillstyle="none" if level else "full",
                linestyle="--" if level else "-",
                markersize=4.5,
                linewidth=1.0,
                elinewidth=0.8,
                label=None if level else look.label,
            )
