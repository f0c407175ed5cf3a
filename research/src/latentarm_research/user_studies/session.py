"""One simulated person's way through one condition of a study."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.tasks.scene_task import SceneTask
from latentarm_research.drives import trace as drives
from latentarm_research.drives.drive import drive
from latentarm_research.metrics.drives import TRIAL_MEASURES, goal_error
from latentarm_research.people.person import Person
from latentarm_research.people.traits import Traits
from latentarm_research.studies.streams import generator
from latentarm_research.user_studies.conditions import setup_of
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.sizes import Sizes, Stream
from latentarm_research.user_studies.trace import Trace, trace_of
from latentarm_research.user_studies.training import Trained

LEAST_S: Final = 1.0  # people begin no attempt for which less time than this is left, s

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
@dataclass(frozen=True, eq=False)
class SessionCell:
    """A person with one condition at one task."""

    definition: Definition  # of the study
    condition: Condition  # that they drive with
    task: StudyTask  # what they do
    traits: Traits  # of the person
    order: int  # place of the condition in the person's order
    trained: Trained | None  # models of the task; None where the condition has none
    sizes: Sizes  # of the run
    seed: int  # of the run


@final
@dataclass(frozen=True, eq=False)
class Session:
    """The result of a `SessionCell`."""

    trials: tuple[Trial, ...]  # in order
    traces: tuple[Trace, ...]  # of each, for figures


def go_through(cell: SessionCell) -> Session:
    """Let the person do all trials of the task.

    The scene, start and chances of an attempt depend on the seed, the person, the task and the numbers of
    trial and attempt alone: they are the same in every condition.
    """
    trials: list[Trial] = []
    traces: list[Trace] = []
    with threadpool_limits(limits=1):
        for number in range(min(cell.task.trials, cell.sizes.most_trials)):
            driven = [
                _attempts(cell, number, choice)
                for choice in choices_of(cell.task, cell.traits.number, number)
            ]
            measured = [
                in_the_end([_measured(cell.task, attempt) for attempt in attempts]) for attempts in driven
            ]
            trials.append(_trial(cell, number, together(measured)))
            traces += [
                trace_of(cell.traits.number, cell.condition.name, cell.task, number, attempt)
                for attempts in driven
                for attempt in attempts
            ]
    return Session(tuple(trials), tuple(traces))


def choices_of(task: StudyTask, person: int, number: int) -> tuple[int, ...]:
    """What a trial is for: all choices one after the other, or the next in turn.

    People begin with different ones.
    """
    if task.all_choices:
        return task.choices
    return (task.choices[(person + number) % len(task.choices)],)


def in_the_end(attempts: Sequence[dict[str, float]]) -> dict[str, float]:
    """The figures of one or more attempts at the same: how far they came in the end, and what it took."""
    best = {name: max(one[name] for one in attempts) for name in ("success_rate", "steps_done")}
    return {**together(attempts), **best, "attempts": float(len(attempts))}


def together(measured: Sequence[dict[str, float]]) -> dict[str, float]:
    """The figures of a trial of several drives; means over time weigh by a drive's duration."""
    time_s = [one["time_s"] for one in measured]
    found: dict[str, float] = {}
    for name in measured[0]:
        values = np.array([one[name] for one in measured])
        if name in SUMMED:
            found[name] = float(values.sum())
        elif name == "success_rate":
            found[name] = float(values.min())
        elif name == "steps_done" or not sum(time_s):
            found[name] = float(values.mean())
        else:
            found[name] = float(np.average(values, weights=time_s))
    return found


def _attempts(cell: SessionCell, number: int, choice: int) -> list[drives.Trace]:
    """One drive, and where the trial's time allows it another one after each that failed."""
    task = scene_of(cell.task.scene)
    left_s = min(cell.task.trial_s or task.time_limit_s, cell.sizes.trial_s)
    driven = [_drive(cell, task, left_s, number, choice, 0)]
    while cell.task.trial_s and not driven[-1].figures.success:
        left_s -= driven[-1].figures.time_s
        if left_s < LEAST_S:
            break
        driven.append(_drive(cell, task, left_s, number, choice, len(driven)))
    return driven


def _drive(
    cell: SessionCell, task: SceneTask, left_s: float, number: int, choice: int, attempt: int
) -> drives.Trace:
    setup = setup_of(cell.condition, task, _person(cell, number), cell.trained, cell.traits.number)
    use = (Stream.TRIALS, cell.traits.number, number, attempt)
    rng = generator(cell.seed, f"{cell.definition.name} {cell.task.name}", *use)
    return drive(setup, choice, rng, time_limit_s=left_s)


def _person(cell: SessionCell, number: int) -> Person:
    """Who they are in this trial: a newcomer where the study is about what they mean by the stick."""
    practice_s = 60.0 * cell.definition.practice_min
    if cell.trained is not None and cell.trained.aligned is not None:
        return cell.traits.newcomer(cell.trained.aligned.usual, number, practice_s)
    return cell.traits.person(number, practice_s)


def _measured(task: StudyTask, trace: drives.Trace) -> dict[str, float]:
    """Figures of one drive; those that have no value are left out."""
    figures = trace.figures
    found = {name: float(getattr(figures, name)) for name in TRIAL_MEASURES}
    found["success_rate"] = float(figures.success)
    if task.plates:
        plates = np.stack([trace.states[0].poses[name].position for name in task.plates])
        found["goal_error_m_s"], found["goal_error_m"] = goal_error(trace.time_s, trace.position, plates)
    return {name: value for name, value in found.items() if np.isfinite(value)}


def _trial(cell: SessionCell, number: int, figures: dict[str, float]) -> Trial:
    return Trial(
        person=cell.traits.number,
        condition=cell.condition.name,
        task=cell.task.name,
        order=cell.order,
        trial=number,
        measures={name: figures[name] for name in cell.definition.measures if name in figures},
    )
