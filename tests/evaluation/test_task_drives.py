"""What is measured of a drive at a task with things."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.core.types import Command, StepRecord
from latentarm.evaluation.summary import Subject
from latentarm_research.metrics.task_drives import (
    alignment_by_step,
    measure_task_drive,
    preference_alignment,
    task_drive_rows,
)

NOTHING = {"steps_done": 0.0, "success": False, "stops": 0, "spilled": 0, "grains": 0}


def record(time_s, u=(0.0, 0.0), mode=0):
    zero = np.zeros(3)
    return StepRecord(
        time_s=time_s,
        state=zero,
        input=np.array(u),
        latent=np.array(u),
        action_human=zero,
        action_assist=zero,
        alpha=0.0,
        belief=np.zeros(0),
        mode=mode,
        command=Command(velocity=zero, duration_s=0.1),
    )


def measured(**changes):
    facts = NOTHING | {"steps_done": 0.5} | changes
    records = [
        record(1.0, (1.0, 0.0)),
        record(1.5, (0.6, 0.8), mode=1),
        record(3.5, mode=1),
        record(4.0, mode=2),
    ]
    position = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 0.0]])
    return measure_task_drive(records, position, 0.9, {"table": 7.0, "thing": 99.0}, **facts)


def test_the_figures_of_a_drive_are_those_of_its_record():
    measures = measured()
    drive = measures.drive
    assert drive.time_s == pytest.approx(3.0)
    assert drive.idle_s == pytest.approx(0.5)
    assert drive.input_magnitude == pytest.approx(0.5 * 1.0 + 2.0 * 1.0)
    assert drive.mode_switches == 2
    assert drive.path_length == pytest.approx(7.0)
    assert (measures.table_force_n, measures.food_force_n) == (7.0, 0.0)


def test_a_drive_without_a_step_has_no_figures():
    with pytest.raises(ValueError, match="without a single step"):
        measure_task_drive([], np.zeros((0, 3)), 0.0, {}, **NOTHING)


def test_pointing_as_needed_is_one_and_the_other_way_minus_one():
    down, out = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    points = np.stack([down, down, out, -down])
    assert preference_alignment(points, np.stack([down] * 4)) == pytest.approx((1 + 1 + 0 - 1) / 4)
    assert np.isnan(preference_alignment(np.zeros((0, 3)), np.zeros((0, 3))))


def test_alignment_by_step_is_the_mean_while_each_was_under_way():
    down, out = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    points = np.stack([down, down, out, -down])
    needed = np.stack([down, out, out, down])
    steps = ("stab", "scoop", "dip", "set down")
    by_step = alignment_by_step(steps, np.array([0, 0, 1, 2]), points, needed)
    assert [(one.step, one.alignment, one.ticks) for one in by_step] == [
        ("stab", 0.5, 2),
        ("scoop", 1.0, 1),
        ("dip", -1.0, 1),
    ]
    whole = preference_alignment(points, needed)
    assert np.average([one.alignment for one in by_step], weights=[one.ticks for one in by_step]) == whole
    assert alignment_by_step(steps, np.zeros(0, int), np.zeros((0, 3)), np.zeros((0, 3))) == ()


def test_every_measure_has_its_row_over_all_drives_failed_ones_too():
    third = measured()
    third = replace(third, drive=replace(third.drive, mode_switches=5))
    drives = [measured(success=True, steps_done=1.0), measured(), third]
    rows = task_drive_rows(Subject("tasks", "dessert", "cvae"), drives)
    assert [row.measure for row in rows] == [
        "success_rate",
        "steps_done",
        "time_s",
        "idle_s",
        "input_magnitude",
        "turned_round",
        "mode_switches",
        "path_length",
        "stops",
        "preference_alignment",
        "table_force_n",
        "food_force_n",
        "spilled_share",
    ]
    of = {row.measure: row for row in rows}
    assert (of["success_rate"].mean, of["success_rate"].n) == (pytest.approx(1 / 3), 3)
    assert of["steps_done"].mean == pytest.approx(2 / 3)
    assert of["mode_switches"].mean == pytest.approx(3.0)


def test_only_where_there_are_grains_can_some_be_spilled():
    subject = Subject("tasks", "dessert")
    without = {row.measure: row for row in task_drive_rows(subject, [measured()])}
    with_some = {row.measure: row for row in task_drive_rows(subject, [measured(spilled=3, grains=12)])}
    assert (without["spilled_share"].mean, without["spilled_share"].n) == (None, 0)
    assert with_some["spilled_share"].mean == pytest.approx(0.25)
