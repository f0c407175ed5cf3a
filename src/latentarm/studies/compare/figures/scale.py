"""A logarithmic axis that also has a zero, for models that undo all of a motion."""

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINEAR_BELOW: Final = 1.0
"""Where the axis is linear, in its own unit."""

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
