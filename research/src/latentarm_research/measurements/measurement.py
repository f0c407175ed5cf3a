"""Inputs and results of every measurement."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeVar, final

from latentarm.core.types import Row

Cell = TypeVar("Cell")
Result = TypeVar("Result")

UNITS: Final = {
    "_rad_s": "rad/s",
    "_m_s": "m/s",
    "_n_mm": "N/mm",
    "_n_m": "N·m",
    "_mm": "mm",
    "_ms": "ms",
    "_nats": "nats",
    "_percent": "%",
    "_deg": "°",
    "_rad": "rad",
    "_m": "m",
    "_n": "N",
    "_s": "s",
}
"""Units by the ending of a measure's name."""


@final
@dataclass(frozen=True)
class Measurement:
    """A measurement as the command line lists it."""

    options: type[Any]  # a frozen dataclass, its own options
    smoke: Mapping[str, object]  # values of options that only show that it runs
    resumes: bool = False  # whether it goes on from its finished runs, also to another number of `runs`

    @property
    def summary(self) -> str:
        """The first line of its help."""
        return self.options.__doc__ or ""


@final
@dataclass(frozen=True)
class Work:
    """How a measurement works."""

    seed: int = 0  # of everything random
    jobs: int = 1  # processes side by side; -1 is one per core
    bars: bool = False  # show progress on standard error
    out: Path = Path()  # the folder of its results

    def each(self, function: Callable[[Cell], Result], cells: Sequence[Cell]) -> list[Result]:
        """Results of a function of picklable cells, in their order."""
        from latentarm.core.parallel import run_grid  # brings joblib, which no help needs

        return run_grid(function, cells, jobs=self.jobs, label=str, bars=self.bars)


@final
@dataclass(frozen=True)
class Outcome:
    """Results of a measurement."""

    rows: Sequence[Row]  # its figures. A task is a table of its own, a condition a line, a measure a column
    broken: Sequence[str] = ()  # a sentence for each stated limit that was not kept
    note: str = ""  # Markdown above the tables
    documents: Mapping[str, object] = field(default_factory=dict[str, object])  # further JSON files by name


def line(
    study: str, condition: str | None, n: int, figures: Mapping[str, Any], task: str | None = None
) -> list[Row]:
    """Rows of one condition: by measure a figure, a mean with its SD, or None where it could not be measured.

    ``task`` is the table that the line belongs to; ``condition`` is None where there is one.
    """
    rows: list[Row] = []
    for measure, figure in figures.items():
        mean, sd = figure if isinstance(figure, tuple) else (figure, None)
        plain = [None if one is None else float(one) for one in (mean, sd)]
        rows.append(Row(study, measure, unit_of(measure), plain[0], plain[1], n, task, condition=condition))
    return rows


def unit_of(measure: str) -> str:
    """Unit of a measure; "1" for a number."""
    return next((unit for ending, unit in UNITS.items() if measure.endswith(ending)), "1")
