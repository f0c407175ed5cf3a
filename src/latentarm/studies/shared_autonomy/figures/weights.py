"""Figure: what the weight of the entropy does to reconstruction and to a change of mind."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.studies.panels import title
from latentarm.studies.shared_autonomy.ablations import weight_label
from latentarm.studies.shared_autonomy.preset import Ablation
from latentarm.studies.shared_autonomy.rows import RECONSTRUCTION, Figure
from latentarm.style import FONT_SIZE, legend_below, look_of, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

HEIGHT_MM: Final = 58.0
NUDGE: Final = 0.08


def weights_figure(
    found: Sequence[Figure], ablation: Ablation, person: str, tasks: Sequence[str]
) -> "Drawing":
    """Reconstruction and final error over lambda_2, a line per arm.

    Args:
        found: every figure of the study.
        ablation: for the weights.
        person: label of the person whose error is drawn.
        tasks: those that were run.
    """
    figure = new_figure(HEIGHT_MM)
    figure.suptitle("Weight of the entropy, mean with 95 % interval; simulated", fontsize=FONT_SIZE)
    left, right = figure.subplots(1, 2)
    labels = [weight_label(weight) for weight in ablation.weights]
    _draw(left, found, tasks, RECONSTRUCTION, labels)
    title(left, "reconstruction")
    left.set_ylabel("test error (% of PCA)", fontsize=FONT_SIZE)
    _draw(right, found, tasks, "final_state_error", [f"{label}, {person}" for label in labels])
    title(right, person)
    right.set_ylabel("final state error", fontsize=FONT_SIZE)
    for axes in (left, right):
        axes.set_ylim(bottom=0.0)
        axes.set_xticks(range(len(labels)), [f"{weight:g}" for weight in ablation.weights])
        axes.set_xlabel("weight $\\lambda_2$", fontsize=FONT_SIZE)
        tidy(axes)
    handles, names = left.get_legend_handles_labels()
    legend_below(figure, handles, names, handle_length=3.0)
    return figure


def _draw(
    axes: "Axes", found: Sequence[Figure], tasks: Sequence[str], measure: str, conditions: Sequence[str]
) -> None:
    known = {(one.task, one.condition, one.measure): one.interval for one in found}
    for index, task in enumerate(tasks):
        look = look_of(task)
        here = [known[task, condition, measure] for condition in conditions]
        axes.errorbar(
            np.arange(len(here)) + NUDGE * (index - (len(tasks) - 1) / 2),
            [one.mean for one in here],
            yerr=[one.half_width for one in here],
            color=look.colour,
            marker=look.marker,
            linestyle=look.dash,
            markersize=3.6,
            linewidth=1.1,
            elinewidth=0.8,
            label=look.label,
        )
