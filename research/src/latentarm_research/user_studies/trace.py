"""The trace of a trial for figures: the tool's path, its distance from the plates, and the stick."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.metrics.preference_alignment import StepAlignment
from latentarm_research.user_studies.definition import StudyTask
from latentarm_research.user_studies.own.records import read_record
from latentarm_research.user_studies.record import read_listed

if TYPE_CHECKING:
    from latentarm_research.drives import trace as drives

POINTS: Final = 60  # of a way and of a course over time, at most
BINS: Final = 17  # of a heat map along each axis
DECIMALS: Final = 4


@final
@dataclass(frozen=True)
class Trace:
    """The trace of one drive."""

    person: int  # their number
    condition: str  # name of the condition
    task: str
    trial: int  # number of the trial
    choice: int  # what it was for
    success: bool  # whether it was done
    time_s: tuple[float, ...]  # (K,), moments evenly over the drive, s
    position: tuple[tuple[float, ...], ...]  # (K, 3), the tool then, m
    # (K,), its distance from the closest plate, m; empty where that is not measured
    plate_m: tuple[float, ...]
    # (BINS, BINS), time that the first two axes were in each cell, s, first axis across; rest does not count
    stick: tuple[tuple[float, ...], ...]
    # *Preference Alignment* in each step that was begun, in order; empty where it was not kept
    aligned: tuple[StepAlignment, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return asdict(self)


def trace_of(person: int, condition: str, task: StudyTask, trial: int, driven: "drives.Trace") -> Trace:
    """The trace of one drive."""
    moments = np.unique(np.linspace(0, len(driven.time_s) - 1, POINTS).astype(int))
    position = driven.position[moments]
    plate_m: FloatArray = np.zeros(0)
    if task.plates:
        plates = np.stack([driven.states[0].poses[name].position for name in task.plates])
        plate_m = np.linalg.norm(position[:, None] - plates, axis=-1).min(axis=1)
    return Trace(
        person=person,
        condition=condition,
        task=task.name,
        trial=trial,
        choice=driven.choice,
        success=driven.figures.success,
        time_s=tuple(_rounded(driven.time_s[moments])),
        position=tuple(tuple(row) for row in _rounded(position)),
        plate_m=tuple(_rounded(plate_m)),
        stick=tuple(tuple(row) for row in _rounded(_stick(driven))),
        aligned=tuple(
            StepAlignment(one.step, round(one.alignment, DECIMALS), one.ticks) for one in driven.aligned
        ),
    )


def read_traces(document: Mapping[str, object], path: Path) -> tuple[Trace, ...]:
    """The traces of a document; see `read_listed`."""
    return read_listed(document, "traces", path, partial(read_record, Trace))


def _stick(driven: "drives.Trace") -> FloatArray:
    pushed = driven.input[driven.input.any(axis=-1)][:, :2]
    edges = np.linspace(-1.0, 1.0, BINS + 1)
    counts = np.histogram2d(pushed[:, 0], pushed[:, 1], bins=(edges, edges))[0]
    period_s = float(np.median(np.diff(driven.time_s))) if len(driven.time_s) > 1 else 0.0
    return counts.T * period_s


def _rounded(values: FloatArray) -> list[Any]:
    return np.round(values, DECIMALS).tolist()
