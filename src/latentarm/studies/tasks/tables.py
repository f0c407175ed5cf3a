"""The study's tables: in Markdown for the page, and at a glance for a terminal."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.table import Table

from latentarm.metrics.looks import look_of
from latentarm.metrics.measures import label_of, unit_of
from latentarm.metrics.table import ABSENT, format_figure
from latentarm.studies.page import markdown_table
from latentarm.studies.tasks.runs import Condition, Run, step_names
from latentarm.types import Row

SUCCESS: Final = "success_rate"

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

GLANCE: Final = ("steps_done", "time_s", "input_magnitude")
"""Measures in a terminal's table."""


def measure_table(rows: Sequence[Row], runs: Mapping[Condition, Sequence[Run]], task: str) -> str:
    """One task: conditions down, measures across; those that no condition has are left out."""
    found = _found(rows, task)
    measures = [name for name in SHOWN if any(name in of for of in found.values())]
    lines = [[condition.label, *_line(found[condition], runs[condition], measures)] for condition in runs]
    return markdown_table(["simulated", "succeeded", *map(_name, measures)], lines)


def failure_table(runs: Mapping[Condition, Sequence[Run]]) -> str:
    """Where the runs of one task ended that did not succeed, and why; empty where all succeeded.

    Steps and reasons down, in the order of the steps; conditions across.
    """
    names = step_names([run for all_of_them in runs.values() for run in all_of_them])
    ends = {
        condition: Counter((run.done, run.why) for run in of if not run.success)
        for condition, of in runs.items()
    }
    places = sorted({place for counts in ends.values() for place in counts})
    if not places:
        return ""
    lines = [
        [_step(names, done), why, *(str(ends[condition][done, why] or ABSENT) for condition in runs)]
        for done, why in places
    ]
    return markdown_table(["ended in step", "why", *(condition.label for condition in runs)], lines)


def summary_tables(
    rows: Sequence[Row], by_task: Mapping[str, Mapping[Condition, Sequence[Run]]]
) -> list[Table]:
    """A table per task, conditions down."""
    return [_summary(rows, runs, task) for task, runs in by_task.items()]


def _summary(rows: Sequence[Row], runs: Mapping[Condition, Sequence[Run]], task: str) -> Table:
    found = _found(rows, task)
    title = f"{look_of(task).label}, simulated"
    table = Table("mean ± SD", title=title, title_justify="left", box=SIMPLE_HEAD)
    for name in ("succeeded", *map(_name, GLANCE)):
        table.add_column(name, justify="right")
    for condition, of in runs.items():
        table.add_row(condition.label, *_line(found[condition], of, GLANCE))
    return table


def _found(rows: Sequence[Row], task: str) -> dict[Condition, dict[str, Row]]:
    """The rows of a task that have a figure, by condition and measure."""
    found: dict[Condition, dict[str, Row]] = {}
    for row in rows:
        if row.task == task and row.mean is not None:
            found.setdefault(Condition(row.condition or "", row.model), {})[row.measure] = row
    return found


def _line(found: Mapping[str, Row], runs: Sequence[Run], measures: Sequence[str]) -> list[str]:
    succeeded = f"{sum(run.success for run in runs)} of {len(runs)}"
    figures = (found.get(name) for name in measures)
    return [succeeded, *(ABSENT if row is None else format_figure(row.mean, row.sd) for row in figures)]


def _name(measure: str) -> str:
    unit = unit_of(measure)
    return label_of(measure) if unit == "1" else f"{label_of(measure)} ({unit})"


def _step(names: Sequence[str], done: int) -> str:
    """A step by its number and kind; after the last one something went wrong."""
    return f"{done + 1}. {names[done]}" if done < len(names) else "after the last"
