"""All runs of the study by task and condition, and its rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from latentarm.core.types import Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.metrics.drives import drive_rows
from latentarm_research.studies.tasks.cell import DemonstratedRun, FittedModel, TaskRunResult
from latentarm_research.studies.tasks.preset import DEMONSTRATOR, Condition, Stream
from latentarm_research.studies.tasks.runs import Run

STUDY: Final = "tasks"


@final
@dataclass(frozen=True, eq=False)
class TasksResults:
    """Everything that was measured."""

    shown: Sequence[DemonstratedRun]  # by the scripted demonstrator
    trained: Sequence[FittedModel]  # models
    driven: Sequence[TaskRunResult]  # by simulated people

    def runs(self, task: str) -> dict[Condition, tuple[Run, ...]]:
        """The runs of a task, by condition, each in the order of their numbers."""
        found: dict[Condition, list[Run]] = {}
        for one in self.shown:
            if (one.cell.task, one.cell.stream) == (task, Stream.RUNS):
                found.setdefault(Condition(DEMONSTRATOR), []).append(one.run)
        for one in self.driven:
            if one.task == task:
                found.setdefault(one.condition, []).append(one.run)
        return {
            condition: tuple(sorted(runs, key=lambda run: run.number)) for condition, runs in found.items()
        }

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


def rows_of(by_task: Mapping[str, Mapping[Condition, Sequence[Run]]]) -> list[Row]:
    """Mean and SD over the runs of every condition, failed ones too."""
    return [
        row
        for task, conditions in by_task.items()
        for condition, runs in conditions.items()
        for row in _rows(Subject(STUDY, task, condition.model, condition.row), runs)
    ]


def runs_as_json(by_task: Mapping[str, Mapping[Condition, Sequence[Run]]]) -> list[dict[str, object]]:
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
