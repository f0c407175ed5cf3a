"""Diverging stacked bars of answers, as in the paper's Likert figures."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.style import SMALL_FONT_SIZE, TWO_COLUMNS_MM, legend_below, literal, new_figure, tidy
from latentarm_research.user_studies.answers.scales import Rated
from latentarm_research.user_studies.definition import Definition

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS: Final = 2
"""Panels in a row."""

BAR_MM: Final = 5.5
PANEL_MM: Final = 17.0
LEGEND_MM: Final = 12.0


def likert_figure(
    definition: Definition,
    rated: Sequence[Rated],  # every scale in every condition; reversed items are turned
    who: str,
) -> "Figure":
    """A panel for each scale; in it a bar for each condition, agreement to the right."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex
    from matplotlib.patches import Patch

    scales, conditions = definition.questionnaire, definition.conditions
    rows = -(-len(scales) // ACROSS)
    figure = new_figure(rows * (PANEL_MM + BAR_MM * len(conditions)) + LEGEND_MM, TWO_COLUMNS_MM)
    panels = figure.subplots(rows, min(ACROSS, len(scales)), squeeze=False, sharex=True).ravel()
    most = max(scale.points for scale in scales)
    for axes, scale in zip(panels, scales, strict=False):
        looks = colormaps["PuOr"](np.linspace(0.1, 0.9, scale.points))
        for place, condition in enumerate(conditions):
            one = next(one for one in rated if (one.scale, one.condition) == (scale.name, condition.name))
            shares = 100.0 * np.array(one.counts) / max(sum(one.counts), 1)
            lower = scale.points // 2
            # Half of the neutral answers stand on either side of 0.
            neutral = shares[lower] / 2.0 if scale.points % 2 else 0.0
            left = -shares[:lower].sum() - neutral
            for share, look in zip(shares, looks, strict=True):
                axes.barh(place, share, left=left, color=look, height=0.7)
                left += share
        axes.set_yticks(range(len(conditions)), [literal(one.name) for one in conditions])
        axes.invert_yaxis()
        axes.set_xlim(-100.0, 100.0)
        axes.set_xticks((-100, -50, 0, 50, 100), ("100", "50", "0", "50", "100"))
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set_title(literal(scale.label))
        tidy(axes)
        axes.grid(False, axis="y")
        axes.tick_params(labelsize=SMALL_FONT_SIZE)
    for axes in panels[len(scales) :]:
        axes.set_visible(False)
    for axes in panels[max(len(scales) - ACROSS, 0) : len(scales)]:
        axes.set_xlabel("answers (%)")
        axes.tick_params(labelbottom=True)
    colours = colormaps["PuOr"](np.linspace(0.1, 0.9, most))
    handles = [Patch(facecolor=to_hex(colour)) for colour in colours]
    points = [str(point) for point in range(1, most + 1)]
    heading = f"{who}: 1 strongly disagree, {most} strongly agree; reversed items turned"
    legend_below(figure, handles, points, heading=heading)
    return figure
