"""The lines that show a planar task."""

from typing import TYPE_CHECKING, Final

from latentarm.tasks.planar.motion import PlanarMotion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GUIDE_COLOUR: Final = "#bbbbbb"


def draw_guides(axes: "Axes", motion: PlanarMotion) -> None:
    """Draw the lines that show a task, in grey behind everything."""
    for guide in motion.guides:
        axes.plot(*guide.T, color=GUIDE_COLOUR, linewidth=1.6, zorder=2)
