"""Figures as a study measures them, one of each run, before they are summed up."""

import math
from typing import NamedTuple, final

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.summary import Subject, summarise


@final
class Series(NamedTuple):
    """One measure of one model under one condition."""

    task: str
    model: str
    condition: str | None  # None in the study's main setting
    measure: str
    values: FloatArray  # (n,), of each run

    def row(self, study: str) -> Row:
        """Mean and SD over the runs."""
        return summarise(Subject(study, self.task, self.model, self.condition), self.measure, self.values)

    def as_json(self) -> dict[str, object]:
        """Plain mapping; figures that are not finite are None."""
        values = [value if math.isfinite(value) else None for value in self.values.tolist()]
        return {**self._asdict(), "values": values}
