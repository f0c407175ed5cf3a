"""The study's figures by model, as panels draw them."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from latentarm.types import Row


class Point(NamedTuple):
    """One model's figure, beside the paper's.

    Attributes:
        mean: over seeds.
        sd: over seeds, 0 where there is one seed.
        paper: the paper's mean, where it reports one.
        paper_sd: 0 where the paper reports none.
    """

    mean: float
    sd: float
    paper: float | None
    paper_sd: float


def points(rows: Iterable[Row], task: str, measure: str, condition: str | None = None) -> dict[str, Point]:
    """One measure by model, of the main table where no condition is named."""
    return {
        row.model: Point(row.mean, row.sd or 0.0, row.paper_mean, row.paper_sd or 0.0)
        for row in rows
        if (row.task, row.measure, row.condition) == (task, measure, condition)
        and row.model is not None
        and row.mean is not None
    }


def in_mm(lengths: Mapping[str, Point]) -> dict[str, Point]:
    """Lengths in metres as millimetres, without the paper's, for which it states no unit."""
    return {model: Point(1000 * point.mean, 1000 * point.sd, None, 0.0) for model, point in lengths.items()}
