"""Measures of a drive at a task with things: steps, forces, what was spilled, and how the tool pointed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.metrics.drives import input_magnitude, mode_switches, path_length
from latentarm.metrics.stick import idle_time, turned_round_share
from latentarm.metrics.summary import Subject, summarise
from latentarm.types import FloatArray, Row, StepRecord


@dataclass(frozen=True, eq=False)
class TaskDrive:
    """Figures of one drive at a task with things.

    Attributes:
        success: all steps were done, and nothing went wrong.
        steps_done: share of the steps that were done.
        time_s: from the first step of the loop to the last, s.
        idle_s: time without input, s.
        input_magnitude: integral of ‖u‖ over time, s (seconds of full deflection of one axis).
        turned_round: share of the time in which the stick points away from where it pointed a moment ago.
        mode_switches: how often the controller's mode changed.
        path_length: way of the tool through space, m.
        preference_alignment: mean over time of the dot product of the direction in which the tool points and
            the one needed at that moment.
        table_force_n: largest force of the tool on the table or a dish, N.
        food_force_n: largest force of the tool on food, N.
        spilled: grains that were spilled.
        grains: grains that there were.
    """

    success: bool
    steps_done: float
    time_s: float
    idle_s: float
    input_magnitude: float
    turned_round: float
    mode_switches: int
    path_length: float
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


def measure_task_drive(
    records: Sequence[StepRecord],
    position: FloatArray,
    alignment: float,
    force_n: Mapping[str, float],
    *,
    steps_done: float,
    success: bool,
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
        spilled: grains that were spilled.
        grains: grains that there were.

    Raises:
        ValueError: there are no records.
    """
    if not records:
        raise ValueError("A drive without a single step has no figures.")
    time_s = np.array([record.time_s for record in records])
    u = np.stack([record.input for record in records])
    return TaskDrive(
        success=success,
        steps_done=steps_done,
        time_s=float(time_s[-1] - time_s[0]),
        idle_s=idle_time(time_s, u),
        input_magnitude=input_magnitude(time_s, u),
        turned_round=turned_round_share(time_s, u),
        mode_switches=mode_switches([record.mode for record in records]),
        path_length=path_length(position),
        preference_alignment=alignment,
        table_force_n=force_n.get("table", 0.0),
        food_force_n=force_n.get("food", 0.0),
        spilled=spilled,
        grains=grains,
    )


TASK_DRIVE_MEASURES = (
    "success_rate",
    "steps_done",
    "time_s",
    "idle_s",
    "input_magnitude",
    "turned_round",
    "mode_switches",
    "path_length",
    "preference_alignment",
    "table_force_n",
    "food_force_n",
    "spilled_share",
)
"""Names in `latentarm.metrics.measures.MEASURES`, in the order of tables."""


def task_drive_rows(subject: Subject, drives: Sequence[TaskDrive]) -> list[Row]:
    """Mean and SD over the drives of one condition, failed ones too."""
    values: dict[str, list[float]] = {
        "success_rate": [float(one.success) for one in drives],
        "spilled_share": [one.spilled / one.grains if one.grains else np.nan for one in drives],
    }
    return [
        summarise(subject, name, values.get(name) or [float(getattr(one, name)) for one in drives])
        for name in TASK_DRIVE_MEASURES
    ]
