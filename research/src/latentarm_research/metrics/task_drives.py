"""Measures of a drive at a task with things: steps, forces, what was spilled, and how the tool pointed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray, IntArray, Row, StepRecord
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.metrics.drives import Drive, drive_rows, measure_drive


@dataclass(frozen=True, eq=False)
class TaskDrive:
    """Figures of one drive at a task with things.

    Attributes:
        drive: those that every drive has; a success is that all steps were done and nothing went wrong.
        steps_done: share of the steps that were done.
        stops: how often the arm was stopped, such as for not following when it met a dish.
        preference_alignment: mean over time of the dot product of the direction in which the tool points and
            the one needed at that moment.
        table_force_n: largest force of the tool on the table or a dish, N.
        food_force_n: largest force of the tool on food, N.
        spilled: grains that were spilled.
        grains: grains that there were.
    """

    drive: Drive
    steps_done: float
    stops: int
    preference_alignment: float
    table_force_n: float
    food_force_n: float
    spilled: int
    grains: int


def preference_alignment(points: FloatArray, needed: FloatArray) -> float:
    """*Preference Alignment* of the paper's third user study: how the tool points, compared with the need.

    Args:
        points: (T, 3), unit vectors along which the tool points.
        needed: (T, 3), unit vectors along which it should.

    Returns:
        The mean dot product, in [-1, 1]; NaN for no moments.
    """
    return float(np.vecdot(points, needed).mean()) if len(points) else np.nan


@final
@dataclass(frozen=True)
class StepAlignment:
    """*Preference Alignment* while one step of a task was under way.

    Attributes:
        step: what was to be done, in words.
        alignment: mean dot product, as `preference_alignment`.
        ticks: of the loop that it took.
    """

    step: str
    alignment: float
    ticks: int


def alignment_by_step(
    steps: Sequence[str], under_way: IntArray, points: FloatArray, needed: FloatArray
) -> tuple[StepAlignment, ...]:
    """*Preference Alignment* in each step that was begun, in order.

    Args:
        steps: all steps in words.
        under_way: (T,), index of the step that was under way.
        points: (T, 3), see `preference_alignment`.
        needed: (T, 3), as there.
    """
    found: list[StepAlignment] = []
    for index, step in enumerate(steps):
        here = under_way == index
        if here.any():
            mean = preference_alignment(points[here], needed[here])
            found.append(StepAlignment(step, mean, int(here.sum())))
    return tuple(found)


def measure_task_drive(
    records: Sequence[StepRecord],
    position: FloatArray,
    alignment: float,
    force_n: Mapping[str, float],
    *,
    steps_done: float,
    success: bool,
    stops: int,
    spilled: int,
    grains: int,
) -> TaskDrive:
    """Figures of a drive from its record.

    Args:
        records: every step of the loop in order.
        position: (T, 3), the tool at each, m.
        alignment: see `preference_alignment`.
        force_n: largest force of the tool on the ``table`` (dishes too) and on ``food``, N.
        steps_done: share of the task's steps.
        success: the task says that it was done.
        stops: how often the arm was stopped.
        spilled: grains that were spilled.
        grains: grains that there were.

    Raises:
        ValueError: there are no records.
    """
    return TaskDrive(
        drive=measure_drive(records, position, success=success),
        steps_done=steps_done,
        stops=stops,
        preference_alignment=alignment,
        table_force_n=force_n.get("table", 0.0),
        food_force_n=force_n.get("food", 0.0),
        spilled=spilled,
        grains=grains,
    )


def task_drive_rows(subject: Subject, drives: Sequence[TaskDrive]) -> list[Row]:
    """Mean and SD over the drives of one condition, failed ones too."""
    succeeded, *how = drive_rows(subject, [one.drive for one in drives])
    spilled = [one.spilled / one.grains if one.grains else np.nan for one in drives]
    return [
        succeeded,
        summarise(subject, "steps_done", [one.steps_done for one in drives]),
        *how,
        summarise(subject, "stops", [float(one.stops) for one in drives]),
        summarise(subject, "preference_alignment", [one.preference_alignment for one in drives]),
        summarise(subject, "table_force_n", [one.table_force_n for one in drives]),
        summarise(subject, "food_force_n", [one.food_force_n for one in drives]),
        summarise(subject, "spilled_share", spilled),
    ]
