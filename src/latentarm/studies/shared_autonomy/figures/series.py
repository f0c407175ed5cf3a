"""Lines with their intervals, one for each method."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.studies.shared_autonomy.cell import METHODS, CellResult, Outcome
from latentarm.studies.shared_autonomy.drive import STEP_S
from latentarm.studies.shared_autonomy.intervals import band, interval
from latentarm.style import legend_below, look_of
from latentarm.types import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NUDGE: Final = 0.015
"""How far methods stand from each other, in the width of what is drawn, so that no bar hides another."""


def outcomes_of(results: Sequence[CellResult], task: str, model: str) -> dict[tuple[str, str], Outcome]:
    """Outcomes of the study proper by method and person."""
    return {
        (one.method, one.person.label): one
        for result in results
        if (result.cell.task, result.cell.model, result.cell.variant) == (task, model, None)
        for one in result.outcomes
    }


def draw_over(
    axes: "Axes",
    outcomes: dict[tuple[str, str], Outcome],
    people: Sequence[str],
    measure: str,
    at: FloatArray | None = None,
) -> None:
    """Mean and 95 % interval of a measure over people, one line per method.

    Args:
        axes: the panel.
        outcomes: by method and person.
        people: labels, from left to right.
        measure: which.
        at: (N,), where each person stands; one after another, evenly, where None.
    """
    places = np.arange(len(people), dtype=float) if at is None else at
    shift = NUDGE * float(np.ptp(places))
    for index, method in enumerate(METHODS):
        if (method, people[0]) not in outcomes:
            continue
        found = [interval(outcomes[method, person].figures[measure]) for person in people]
        look = look_of(method)
        axes.errorbar(
            places + (index - 1) * shift,
            [one.mean for one in found],
            yerr=[one.half_width for one in found],
            color=look.colour,
            marker=look.marker,
            linestyle=look.dash,
            markersize=3.6,
            linewidth=1.1,
            elinewidth=0.8,
            label=look.label,
            zorder=3 + index,
        )


def draw_course(axes: "Axes", outcomes: dict[tuple[str, str], Outcome], person: str, what: str) -> None:
    """State error or belief over time, one line per method with its 95 % interval as a band.

    Args:
        axes: the panel.
        outcomes: by method and person.
        person: label.
        what: ``error`` or ``belief``.
    """
    for index, method in enumerate(METHODS):
        if (method, person) not in outcomes:
            continue
        mean, low, high = band(getattr(outcomes[method, person], what))
        time_s = STEP_S * np.arange(len(mean))
        look = look_of(method)
        axes.fill_between(time_s, low, high, color=look.colour, alpha=0.2, linewidth=0.0)
        every = max(len(mean) // 5, 1)
        axes.plot(
            time_s,
            mean,
            color=look.colour,
            linestyle=look.dash,
            linewidth=1.1,
            marker=look.marker,
            markersize=3.4,
            # Each method's markers stand elsewhere, so that lines on top of each other are seen.
            markevery=(every * (index + 1) // 4, every),
            label=look.label,
            zorder=3 + index,
        )


def name_methods(figure: "Figure", *panels: "Axes") -> None:
    """A legend below all panels, from the labels of some of them; what has a name twice is named once."""
    named = {
        label: handle
        for axes in panels
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    legend_below(figure, list(named.values()), list(named), handle_length=3.0)
