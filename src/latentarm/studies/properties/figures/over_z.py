"""Panel: what a 1-D latent action does over z, one line per state."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from latentarm.metrics.effects import axis_grid
from latentarm.metrics.table import format_figure
from latentarm.studies.panels import note
from latentarm.studies.properties.figures.panels import points
from latentarm.style import SMALL_FONT_SIZE, look_of, tidy
from latentarm.types import FloatArray, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GRID: Final = axis_grid(21)
DASHES: Final = ("-", "--", ":")


def draw_over_z(axes: "Axes", rows: Sequence[Row], task: str, model: str, effect: FloatArray) -> None:
    """Draw an effect over z, and say how well a line fits it over all seeds and more states.

    Args:
        axes: where to draw.
        rows: of the study, for R^2.
        task: which task.
        model: whose effect.
        effect: (K, 3), at the K values of `GRID`, in three states, in the unit of the y axis.
    """
    for place, (values, dash) in enumerate(zip(effect.T, DASHES, strict=True)):
        axes.plot(
            GRID,
            values,
            color=look_of(model).colour,
            linestyle=dash,
            linewidth=1.2,
            label=f"state {place + 1}",
        )
    fit = points(rows, task, "r2").get(model)
    if fit is not None:
        note(axes, f"$R^2$ = {format_figure(fit.mean, fit.sd)}", high=True)
    axes.set_xlabel("z")
    axes.legend(loc="lower right", fontsize=SMALL_FONT_SIZE, frameon=False, borderaxespad=0.0)
    tidy(axes)
