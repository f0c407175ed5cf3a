"""Panel: what each model leaves of PCA's loss, as in part A of the paper's figures."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from latentarm.studies.panels import title
from latentarm.studies.properties.figures.dots import beside, draw_points, log_axis
from latentarm.studies.properties.figures.panels import points
from latentarm.types import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_losses(axes: "Axes", rows: Sequence[Row], task: str) -> None:
    """Test loss in percent of PCA's on a logarithmic axis, with the paper's.

    Args:
        axes: where to draw.
        rows: of the study; those of other tasks and measures are passed over.
        task: which task.
    """
    losses = points(rows, task, "error_percent_of_pca")
    draw_points(axes, losses, log_axis(axes, losses.values()))
    title(axes, "test loss, mean ± SD", "A")
    axes.set_xlabel(f"% of PCA's{beside(losses)}")
