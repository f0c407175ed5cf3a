"""The record of one drive of a trial, the same for simulated and real people, and trials of such drives."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Annotated, Final, Literal, NamedTuple, final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from latentarm_research.drives import trace as drives
from latentarm_research.metrics.drives import TRIAL_MEASURES, goal_error
from latentarm_research.metrics.ending import Reason
from latentarm_research.user_studies.definition import StudyTask
from latentarm_research.user_studies.own.measures import OWN_MEASURES, own_figures
from latentarm_research.user_studies.record import PeopleAre, Trial
from latentarm_research.user_studies.trace import Trace, trace_of

Count = Annotated[int, Field(ge=0)]

SUMMED: Final = (
    "attempts",
    "time_s",
    "idle_s",
    "input_magnitude",
    "mode_switches",
    "path_length",
    "stops",
    "goal_error_m_s",
)
"""Figures of a trial of several drives that are sums over them; of the others the mean is taken, and it
succeeds where all do."""


@final
class DriveRecord(BaseModel):
    """One drive of a trial, by a simulated or a real person.

    A trial is one drive for each choice, and another after each failed one while time is left. The docs
    publish this class as a JSON schema.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    version: Literal[1] = 1
    people_are: PeopleAre
    person: Count = Field(description="number of the person")
    condition: str = Field(description="name of the condition")
    order: Count = Field(description="place of the condition in the person's order, from 0")
    task: str = Field(description="name of the task")
    trial: Count = Field(description="number of the trial in this condition, from 0")
    choice: Count = Field(description="index into the choices of the task's scene")
    attempt: Count = Field(description="number of earlier drives at this choice in this trial")
    ending: Reason = Field(description="why it ended")
    measures: Mapping[str, float] = Field(
        description="figures by name; what has no value is absent. input_delay_s, on the page: from a state"
        " of the arm to the input that answered it, mean over the drive, s"
    )
    input_s: Mapping[str, float] = Field(
        default_factory=dict,
        description="on the page: how long each input device was pushed, s. `pointer` is the stick on the"
        " page and `dpad` its buttons, each with mouse, touch or pen; `keyboard`; `gamepad`"
        " with its id; `switch`",
    )
    trace: Trace = Field(description="the tool's path and the stick, thinned out for figures")


@final
class DriveContext(NamedTuple):
    """The place of a drive in a study; see `DriveRecord`."""

    people_are: PeopleAre
    person: int
    condition: str
    order: int
    trial: int
    attempt: int


def record_of(where: DriveContext, task: StudyTask, driven: drives.Trace) -> DriveRecord:
    """The record of a drive from its trace."""
    return DriveRecord(
        **where._asdict(),
        task=task.name,
        choice=driven.choice,
        ending=driven.ending.reason,
        measures=_measured(task, driven),
        trace=trace_of(where.person, where.condition, task, where.trial, driven),
    )


def trial_of(measures: Sequence[str], driven: Sequence[DriveRecord]) -> Trial:
    """The trial that drives make, in their order; ``measures`` are those that the study keeps."""
    one = driven[0]
    by_choice = [list(attempts) for _, attempts in groupby(driven, lambda drive: drive.choice)]
    found = together([in_the_end([drive.measures for drive in attempts]) for attempts in by_choice])
    kept = {name: found[name] for name in measures if name in found}
    return Trial(one.person, one.condition, one.task, one.order, one.trial, kept)


def devices_of(driven: Sequence[DriveRecord]) -> tuple[str, ...]:
    """The input devices of drives, the longest pushed first."""
    pushed_s: Counter[str] = Counter()
    for drive in driven:
        pushed_s.update(drive.input_s)
    return tuple(name for name, _ in pushed_s.most_common())


def in_the_end(attempts: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """The figures of one or more attempts at the same: how far they came in the end, and what it took."""
    best = {name: max(one[name] for one in attempts) for name in ("success_rate", "steps_done")}
    return {**together(attempts), **best, "attempts": float(len(attempts))}


def together(measured: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """The figures of a trial of several drives; means over time weigh by a drive's duration."""
    time_s = [one["time_s"] for one in measured]
    found: dict[str, float] = {}
    for name in (name for name in measured[0] if all(name in one for one in measured)):
        values = np.array([one[name] for one in measured])
        if name in SUMMED or (name in OWN_MEASURES and OWN_MEASURES[name].summed):
            found[name] = float(values.sum())
        elif name == "success_rate":
            found[name] = float(values.min())
        elif name == "steps_done" or not sum(time_s):
            found[name] = float(values.mean())
        else:
            found[name] = float(np.average(values, weights=time_s))
    return found


def _measured(task: StudyTask, trace: drives.Trace) -> dict[str, float]:
    """Figures of one drive; those that have no value are left out."""
    figures = trace.figures
    found = {name: float(getattr(figures, name)) for name in TRIAL_MEASURES}
    found["success_rate"] = float(figures.success)
    found |= own_figures(trace)
    if (measured := np.isfinite(trace.delay_s)).any():
        found["input_delay_s"] = float(trace.delay_s[measured].mean())
    if task.plates:
        plates = np.stack([trace.states[0].poses[name].position for name in task.plates])
        found["goal_error_m_s"], found["goal_error_m"] = goal_error(trace.time_s, trace.position, plates)
    return {name: value for name, value in found.items() if np.isfinite(value)}
