"""Trials as figures that can be compared: a mean of each person, or all trials of a comparison as columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.claims import Claim
from latentarm_research.user_studies.record import Trial


@final
@dataclass(frozen=True, eq=False)
class Sides:
    """The two sides of a comparison: the same people on both, in the same rows, or different ones."""

    people: tuple[int, ...]  # numbers of the people on the subject's side
    subject: FloatArray  # (n,), mean of each under the conditions that a claim is about
    against: FloatArray  # (m,), of each on the other side, under the others
    people_against: tuple[int, ...]  # numbers of the people there

    @property
    def differences(self) -> FloatArray:
        """(n,), subject less against, where the same people stand on both sides."""
        return self.subject - self.against


def person_mean(
    trials: Sequence[Trial], person: int, measure: str, conditions: Sequence[str], tasks: Sequence[str]
) -> float:
    """A person's mean over trials, then tasks, then conditions; NaN where one of these has no figure."""
    cells = [
        [
            trial.measures[measure]
            for trial in trials
            if (trial.person, trial.condition, trial.task) == (person, condition, task)
            and measure in trial.measures
        ]
        for condition in conditions
        for task in tasks
    ]
    return float(np.mean([np.mean(cell) for cell in cells])) if all(cells) else np.nan


def tasks_of(trials: Sequence[Trial], claim: Claim) -> tuple[str, ...]:
    """The tasks that a claim is about: those that it names, or all that any trial has its measure for."""
    return claim.tasks or tuple(
        dict.fromkeys(trial.task for trial in trials if claim.measure in trial.measures)
    )


def sides(trials: Sequence[Trial], claim: Claim) -> Sides:
    """Both sides of a claim, of all people who have both; nobody where the measure is missing."""
    tasks = tasks_of(trials, claim)
    people = sorted({trial.person for trial in trials}) if tasks else []
    by_person = {person: [trial for trial in trials if trial.person == person] for person in people}
    both = np.array(
        [
            [
                person_mean(by_person[person], person, claim.measure, side, tasks)
                for side in (claim.subject, claim.against)
            ]
            for person in people
        ]
    ).reshape(-1, 2)
    whole = np.flatnonzero(np.isfinite(both).all(axis=1))
    numbers = tuple(people[row] for row in whole)
    return Sides(numbers, both[whole, 0], both[whole, 1], numbers)


def groups(trials: Sequence[Trial], claim: Claim) -> Sides:
    """Both sides of a claim of a study in which each person meets one condition."""
    tasks = tasks_of(trials, claim)
    found: list[tuple[tuple[int, ...], FloatArray]] = []
    for side in (claim.subject, claim.against):
        met = {trial.person: trial.condition for trial in trials if tasks and trial.condition in side}
        means = {
            person: person_mean(trials, person, claim.measure, (met[person],), tasks)
            for person in sorted(met)
        }
        known = {person: mean for person, mean in means.items() if np.isfinite(mean)}
        found.append((tuple(known), np.array(list(known.values()), dtype=float)))
    (people, subject), (others, against) = found
    return Sides(people, subject, against, others)


@final
@dataclass(frozen=True, eq=False)
class LongTable:
    """Trials of the people whom a claim compares."""

    value: FloatArray  # (N,), the measure
    label: FloatArray  # (N,), +0.5 where the condition is one that the claim is about, -0.5 elsewhere
    person: np.ndarray[tuple[int], np.dtype[np.intp]]  # (N,), index of the person, from 0
    # (N, k), place of the condition in the person's order and number of the trial, both centred, and a column
    # for each task but the first; those that do not vary are left out
    covariates: FloatArray

    @property
    def people(self) -> int:
        """How many."""
        return int(self.person.max()) + 1 if len(self.person) else 0


def long_table(
    trials: Sequence[Trial],
    claim: Claim,
    *,
    on_both: bool,  # whether the same people stand on both sides, so that only those with both count
) -> LongTable:
    """The trials that a claim compares."""
    tasks = tasks_of(trials, claim)
    every = [
        trial
        for trial in trials
        if trial.condition in {*claim.subject, *claim.against}
        and trial.task in tasks
        and claim.measure in trial.measures
    ]
    on_side = {
        side: {trial.person for trial in every if trial.condition in conditions}
        for side, conditions in (("subject", claim.subject), ("against", claim.against))
    }
    subject, against = on_side["subject"], on_side["against"]
    people = sorted(subject & against if on_both else subject | against)
    kept = [trial for trial in every if trial.person in people]
    columns = np.array(
        [[trial.order, trial.trial, *(float(trial.task == task) for task in tasks[1:])] for trial in kept],
        dtype=float,
    ).reshape(len(kept), 1 + len(tasks) if tasks else 2)
    columns = columns - (columns.mean(axis=0) if len(kept) else 0.0)
    return LongTable(
        value=np.array([trial.measures[claim.measure] for trial in kept], dtype=float),
        label=np.array([0.5 if trial.condition in claim.subject else -0.5 for trial in kept]),
        person=np.array([people.index(trial.person) for trial in kept], dtype=np.intp),
        covariates=columns[:, np.abs(columns).max(axis=0, initial=0.0) > 0.0],
    )
