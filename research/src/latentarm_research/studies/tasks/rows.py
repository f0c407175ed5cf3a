"""All runs of the study by task and condition, and its rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from latentarm.core.types import Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.metrics.drives import drive_rows
from latentarm_research.studies.tasks.cell import DemonstratedRun, FittedModel, TaskRunCell
from latentarm_research.studies.tasks.preset import DEMONSTRATOR, Condition, Stream
from latentarm_research.studies.tasks.runs import Run

STUDY: Final = "tasks"


ByTask = Mapping[str, Mapping[Condition, Sequence[Run]]]
"""The runs of each task, by condition, each in the order of their numbers."""


@final
@dataclass(frozen=True, eq=False)
class TasksResults:
    """Everything that was measured."""

    shown: Sequence[DemonstratedRun]  # by the scripted demonstrator
    trained: Sequence[FittedModel]  # models
    driven: Sequence[tuple[TaskRunCell, Run]]  # by simulated people

    def by_task(self, tasks: Sequence[str]) -> ByTask:
        """All runs that are no demonstrations to learn from."""
        found: dict[str, dict[Condition, list[Run]]] = {task: {} for task in tasks}
        for one in self.shown:
            if one.cell.stream == Stream.RUNS:
                found[one.cell.task].setdefault(Condition(DEMONSTRATOR), []).append(one.run)
        for cell, run in self.driven:
            found[cell.task].setdefault(cell.condition, []).append(run)
        for by_condition in found.values():
            for runs in by_condition.values():
                runs.sort(key=lambda run: run.number)
        return found

    def fit_s(self, context: str) -> dict[Condition, float]:
        """The decoders that see a context, and how long each trained for all tasks, s."""
        found: dict[Condition, float] = {}
        for one in self.trained:
            if one.condition.name == context:
                found[one.condition] = found.get(one.condition, 0.0) + one.fit_s
        return found

    def demonstrated(self, task: str) -> tuple[int, float]:
        """How many demonstrations of a task trained the models, and how long these were together, s."""
        kept = [
            one.run
            for one in self.shown
            if (one.cell.task, one.cell.stream) == (task, Stream.DEMONSTRATIONS) and one.run.success
        ]
        return len(kept), sum(run.time_s for run in kept)


def rows_of(by_task: ByTask) -> list[Row]:
    """Mean and SD over the runs of every condition, failed ones too."""
    return [
        row
        for task, conditions in by_task.items()
        for condition, runs in conditions.items()
        for row in _rows(Subject(STUDY, task, condition.model, condition.row), runs)
    ]


def runs_as_json(by_task: ByTask) -> list[dict[str, object]]:
    """Every run."""
    return [
        {
            "task": task,
            "model": condition.model,
            "condition": condition.name,
            "way_back": condition.way_back,
            "beside": condition.beside,
            "person": condition.person,
            **run.as_json(),
        }
        for task, conditions in by_task.items()
        for condition, runs in conditions.items()
        for run in runs
    ]


def _rows(subject: Subject, runs: Sequence[Run]) -> list[Row]:
    drives = [run.figures for run in runs if run.figures is not None]
    if drives:
        return drive_rows(subject, drives)
    return [
        summarise(subject, "success_rate", [float(run.success) for run in runs]),
        summarise(subject, "steps_done", [run.done / len(run.steps) for run in runs]),
        summarise(subject, "time_s", [run.time_s for run in runs]),
    ]
