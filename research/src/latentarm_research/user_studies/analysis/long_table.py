"""The trials of a comparison as columns, for models of all trials at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.user_studies.analysis.means import tasks_of
from latentarm_research.user_studies.hypothesis import Claim
from latentarm_research.user_studies.record import Trial


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
