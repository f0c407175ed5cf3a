"""The study's tables: in Markdown for the page, and at a glance for a terminal."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from statistics import median
from typing import TYPE_CHECKING, Final

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.tables import heading, markdown_table, terminal_table
from latentarm_research.studies.tasks.preset import SWITCHING, Condition
from latentarm_research.studies.tasks.rows import ByTask
from latentarm_research.studies.tasks.runs import Run, step_names, time_ratios

if TYPE_CHECKING:
    from rich.table import Table

SHOWN: Final = (
    "steps_done",
    "time_s",
    "input_magnitude",
    "mode_switches",
    "stops",
    "table_force_n",
    "food_force_n",
    "spilled_share",
    "preference_alignment",
)
"""Measures in the page's table, after how many runs succeeded."""


def success_table(runs: Mapping[Condition, Sequence[Run]]) -> str:
    """How many runs of one task succeeded: what moves the arm down, people across."""
    head, *lines = _by_person(runs, lambda condition: _succeeded(runs[condition]))
    return markdown_table(head, lines)


def time_table(runs: Mapping[Condition, Sequence[Run]]) -> str:
    """Median time of the runs of one task that succeeded, s, and how it compares with mode switching.

    Behind it stands the median ratio to the time of the same person's run by mode switching with the same
    scene, over those of which both succeeded.
    """

    def text(condition: Condition) -> str:
        times = [run.time_s for run in runs[condition] if run.success]
        switched = Condition(SWITCHING).by(condition.person)
        ratios = [] if condition == switched else time_ratios(runs[condition], runs.get(switched, ()))
        beside = f" ({median(ratios):.2f})" if ratios else ""
        return f"{median(times):.0f}{beside}" if times else ABSENT

    head, *lines = _by_person(runs, text)
    return markdown_table(head, lines)


def _by_person(runs: Mapping[Condition, Sequence[Run]], text: Callable[[Condition], str]) -> list[list[str]]:
    """Head and lines of one text for each condition; the demonstrator is left out."""
    driven = [condition for condition in runs if condition.person is not None]
    people = dict.fromkeys(condition.person for condition in driven)
    lines = [
        [what.label, *(text(what.by(person)) if what.by(person) in runs else ABSENT for person in people)]
        for what in dict.fromkeys(condition.by(None) for condition in driven)
    ]
    return [["simulated", *map(str, people)], *lines]


def measure_table(rows: Sequence[Row], runs: Mapping[Condition, Sequence[Run]], task: str) -> str:
    """One task: conditions down, measures across; those that no condition has are left out."""
    found = {
        (row.model, row.condition, row.measure): format_figure(row.mean, row.sd)
        for row in rows
        if row.task == task and row.mean is not None
    }
    measures = [name for name in SHOWN if any(name == measure for _, _, measure in found)]
    lines = [
        [
            condition.label,
            condition.person,
            _succeeded(of),
            *(found.get((condition.model, condition.row, name)) for name in measures),
        ]
        for condition, of in runs.items()
    ]
    return markdown_table(["simulated", "person", "succeeded", *map(heading, measures)], lines)


def failure_table(runs: Mapping[Condition, Sequence[Run]]) -> str:
    """Where the runs of one task ended that did not succeed, and why; empty where all succeeded.

    People, steps and reasons down, in the order of the steps; what moves the arm across.
    """
    names = step_names([run for all_of_them in runs.values() for run in all_of_them])
    ends = Counter(
        (condition, run.done, run.why) for condition, of in runs.items() for run in of if not run.success
    )
    if not ends:
        return ""
    people = list(dict.fromkeys(condition.person for condition in runs))
    moves = dict.fromkeys(condition.by(None) for condition in runs)
    places = sorted({(people.index(condition.person), done, why) for condition, done, why in ends})
    lines = [
        [
            people[who],
            _step(names, done),
            why,
            *(str(ends[what.by(people[who]), done, why] or ABSENT) for what in moves),
        ]
        for who, done, why in places
    ]
    return markdown_table(["person", "ended in step", "why", *(what.label for what in moves)], lines)


def summary_tables(by_task: ByTask) -> "list[Table]":
    """How many runs succeeded: a table per task, what moves the arm down, people across."""
    tables: list[Table] = []
    for task, runs in by_task.items():
        head, *lines = _by_person(runs, lambda condition, runs=runs: _succeeded(runs[condition]))
        tables.append(terminal_table(f"{look_of(task).label}, runs that succeeded, simulated", head, lines))
    return tables


def _succeeded(runs: Sequence[Run]) -> str:
    return f"{sum(run.success for run in runs)} of {len(runs)}"


def _step(names: Sequence[str], done: int) -> str:
    """A step by its number and kind; after the last one something went wrong."""
    return f"{done + 1}. {names[done]}" if done < len(names) else "after the last"
