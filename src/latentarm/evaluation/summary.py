"""Summarises values per seed or per drive as the rows that every command prints."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from latentarm.core.types import Row
from latentarm.evaluation.measures import unit_of


@dataclass(frozen=True)
class Subject:
    """The subject of a row."""

    study: str  # the command or simulation that took the figures
    task: str | None = None
    model: str | None = None
    condition: str | None = None  # the varied setting


def summarise(subject: Subject, measure: str, values: ArrayLike) -> Row:
    """Mean and sample SD over runs (n,), without those that have no figure (NaN).

    The SD is absent for a single run, and the mean where no run has a figure.
    """
    known = np.asarray(values, dtype=np.float64).reshape(-1)
    known = known[np.isfinite(known)]
    return Row(
        study=subject.study,
        measure=measure,
        unit=unit_of(measure),
        mean=float(known.mean()) if len(known) else None,
        sd=float(known.std(ddof=1)) if len(known) > 1 else None,
        n=len(known),
        task=subject.task,
        model=subject.model,
        condition=subject.condition,
    )
