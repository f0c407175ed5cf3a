"""Means with 95 % intervals of drives that come in clusters: those with one trained model are one cluster."""

from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

from scipy import stats

from latentarm.core.types import FloatArray
from latentarm_research.studies.means_test import CONFIDENCE
from latentarm_research.studies.statistics import bootstrap_interval

FEWEST_SEEDS: Final = 3
"""From this many on, seeds are the units; with fewer there is no spread to estimate, so drives are."""


@dataclass(frozen=True)
class Interval:
    """A mean and what it could well be."""

    mean: float  # over the units
    sd: float  # over the units; 0 for one unit
    n: int  # units
    over: Literal["seeds", "drives"]  # what they are

    @property
    def half_width(self) -> float:
        """Of the interval for the mean by Student's t, ``t sd / sqrt(n)``; 0 for one unit."""
        return student(self.n) * self.sd / self.n**0.5

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.mean - self.half_width

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.mean + self.half_width


def interval(
    values: FloatArray,  # (S, P), of S seeds' P drives; (S, 1) for figures of the seeds themselves
) -> Interval:
    """Mean and interval of what was measured of drives.

    Returns:
        Over the seeds' means, or over all drives of fewer than `FEWEST_SEEDS` seeds.
    """
    seeds = len(values) >= FEWEST_SEEDS or values.shape[1] == 1
    units = values.mean(axis=1) if seeds else values.reshape(-1)
    return Interval(
        mean=float(units.mean()),
        sd=float(units.std(ddof=1)) if len(units) > 1 else 0.0,
        n=len(units),
        over="seeds" if seeds else "drives",
    )


def student(n: int) -> float:
    """How many standard errors an interval over n units reaches to each side."""
    return float(stats.t.ppf((1.0 + CONFIDENCE) / 2.0, n - 1)) if n > 1 else 0.0


class Band(NamedTuple):
    """What seeds did over time, each (T,)."""

    mean: FloatArray  # over seeds
    low: FloatArray  # lower end of the 95 % bootstrap interval for the mean
    high: FloatArray  # upper end


def band(courses: FloatArray) -> Band:
    """Mean and interval of what S seeds did over time, (S, T); the mean alone for fewer than three."""
    mean = courses.mean(axis=0)
    if len(courses) < FEWEST_SEEDS:
        return Band(mean, mean, mean)
    return Band(mean, *bootstrap_interval(courses))
