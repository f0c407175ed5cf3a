"""Measures of drives that other distributions register as entry points of `latentarm.study_measures`."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

from latentarm.core.plugins import Catalogue
from latentarm.evaluation.measures import MEASURES, Measure
from latentarm_research.drives.trace import Trace


@final
@dataclass(frozen=True)
class OwnMeasure:
    """A figure of each drive."""

    about: Measure  # for tables and the codebook
    of: Callable[[Trace], float]  # its value for a drive; NaN for a drive without one
    # True if a trial's figure is the sum over its drives, False for the mean, weighted by their times
    summed: bool = False


def _own_measure(name: str, thing: object) -> OwnMeasure:
    if not isinstance(thing, OwnMeasure):
        raise TypeError(f"{thing!r} is no {__name__}.OwnMeasure")
    if MEASURES.setdefault(name, thing.about) is not thing.about:
        raise ValueError("there is a measure of that name already")
    return thing


OWN_MEASURES: Final = Catalogue("latentarm.study_measures", "measure", {}, _own_measure)
"""Each is measured in every drive of a study; a definition names those that it keeps."""


def own_figures(drive: Trace) -> dict[str, float]:
    """The figures of a drive by the measures that load."""
    return {
        name: float(OWN_MEASURES.running(name, lambda own=own: own.of(drive)))
        for name, own in OWN_MEASURES.usable().items()
    }
