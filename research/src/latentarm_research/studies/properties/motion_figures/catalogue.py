"""The figure of each task: what latent actions do on it.

Each is drawn from one decoder per model, of the first seed, and the study's rows.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from latentarm.core.types import Row
from latentarm_research.studies.properties.motion_figures.circle import circle_figure
from latentarm_research.studies.properties.motion_figures.reach import reach_figure
from latentarm_research.studies.properties.motion_figures.rotate import rotate_figure
from latentarm_research.studies.properties.motion_figures.shown import Decoders
from latentarm_research.studies.properties.motion_figures.sine import sine_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


TASK_FIGURES: Final[dict[str, Callable[[Decoders, Sequence[Row]], "Figure"]]] = {
    "sine": sine_figure,
    "rotate": rotate_figure,
    "circle": circle_figure,
    "reach": reach_figure,
}
"""The figure of each task."""
