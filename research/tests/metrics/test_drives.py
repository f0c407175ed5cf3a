from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.types import Command, Pose, StepRecord
from latentarm.evaluation.summary import Subject
from latentarm_research.metrics.drives import (
    drive_rows,
    measure_drive,
    path_length,
)
from made_drives import drive_of


def record(time_s, u=(0.0, 0.0), mode=0):
    zero = np.zeros(3)
    return StepRecord(
        time_s=time_s,
        state=zero,
        input=np.asarray(u, dtype=float),
        latent=np.asarray(u, dtype=float),
        action_human=zero,
        action_assist=zero,
        alpha=0.0,
        belief=np.zeros(0),
        mode=mode,
        command=Command(velocity=zero, duration_s=0.1),
    )


def at(*positions):
    """Where the tool was, never turned."""
    return Pose(np.array(positions, dtype=float), np.broadcast_to(np.eye(3), (len(positions), 3, 3)))


def outcome(target=(0.0, 0.0, 0.0), goals=(), **changes):
    at_task = asdict(drive_of(False))
    names = ("success", "steps_done", "stops", "preference_alignment", "spilled", "grains")
    forces = {"table_force_n": np.nan, "food_force_n": np.nan}
    facts = {name: at_task[name] for name in names} | forces | changes
    return {"target": Pose(np.array(target), np.eye(3)), "goals": np.array(goals, dtype=float), **facts}


def measured(**changes):
    records = [
        record(1.0, u=(1.0, 0.0)),
        record(1.5, u=(0.6, 0.8), mode=1),
        record(3.5, mode=1),
        record(4.0, mode=0),
    ]
    tool = at((0, 0, 0), (3, 0, 0), (3, 4, 0), (3, 4, 0))
    facts = {"target": (3.0, 4.0, 2.0), "goals": ((0, 0, 1), (3, 4, 2))} | changes
    return measure_drive(records, tool, **outcome(**facts))


def test_the_figures_of_a_drive_are_those_of_its_record():
    drive = measured()
    assert drive.time_s == pytest.approx(3.0)
    assert drive.idle_s == pytest.approx(0.5)
    # 1 m from the other goal, then √10 from it (√20 from the target), then 2 from the target.
    assert drive.goal_error_m_s == pytest.approx(0.5 * 1.0 + 2.0 * np.sqrt(10.0) + 0.5 * 2.0)
    assert drive.goal_error_m == pytest.approx(drive.goal_error_m_s / 3.0)
    assert drive.input_magnitude == pytest.approx(0.5 * 1.0 + 2.0 * 1.0)
    assert drive.mode_switches == 2
    assert drive.path_length == pytest.approx(7.0)
    assert drive.final_distance == pytest.approx(2.0)
    assert drive.final_angle_deg == 0.0


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=2, max_size=20))
def test_input_is_at_most_that_of_both_axes_fully_pushed_while_any_is(inputs):
    records = [record(0.01 * index, u) for index, u in enumerate(inputs)]
    drive = measure_drive(records, at(*[(0, 0, 0)] * len(inputs)), **outcome())
    pushed_s = drive.time_s - drive.idle_s
    assert 0.0 <= drive.input_magnitude <= np.sqrt(2.0) * pushed_s + 1e-12


def test_a_drive_of_one_step_went_nowhere():
    drive = measure_drive([record(2.0, u=(1.0, 0.0))], at((1, 0, 0)), **outcome(goals=((0, 0, 0),)))
    assert (drive.time_s, drive.input_magnitude, drive.path_length) == (0.0, 0.0, 0.0)
    assert (drive.idle_s, drive.turned_round, drive.goal_error_m_s) == (0.0, 0.0, 0.0)
    assert drive.goal_error_m == pytest.approx(1.0)
    assert drive.final_distance == pytest.approx(1.0)


def test_no_steps_are_no_drive():
    with pytest.raises(ValueError, match="without a single step"):
        measure_drive([], at((0, 0, 0)), **outcome())


def test_rows_hold_mean_sd_and_number_of_a_condition_failed_drives_too():
    some = measured(success=True, steps_done=1.0)
    drives = [replace(some, time_s=4.0), replace(some, success=False, time_s=8.0, mode_switches=4)]
    rows = {
        row.measure: row for row in drive_rows(Subject("drive", task="table", condition="latent"), drives)
    }
    assert rows["success_rate"].mean == 0.5
    assert rows["time_s"].mean == pytest.approx(6.0)
    assert rows["time_s"].sd == pytest.approx(np.std([4.0, 8.0], ddof=1))
    assert rows["mode_switches"].mean == pytest.approx(3.0)
    assert rows["goal_error_m_s"].unit == "m s"
    assert {row.n for row in rows.values()} == {2}
    assert {row.condition for row in rows.values()} == {"latent"}
    assert rows["path_length"].unit == rows["final_distance"].unit == "m"


def test_where_nothing_can_be_touched_there_are_no_rows_of_forces():
    def forces(**forces_n):
        rows = drive_rows(Subject("drive"), [measured(**forces_n)])
        return {row.measure: row.mean for row in rows if row.unit == "N"}

    assert forces() == {}
    assert forces(table_force_n=7.0, food_force_n=0.0) == {"table_force_n": 7.0, "food_force_n": 0.0}


def test_only_where_there_are_goals_is_there_an_error_from_them():
    rows = {row.measure for row in drive_rows(Subject("drive"), [measured(goals=())])}
    assert rows.isdisjoint({"goal_error_m_s", "goal_error_m"})


def test_only_where_there_are_grains_can_some_be_spilled():
    without = {row.measure for row in drive_rows(Subject("tasks"), [measured()])}
    with_some = {row.measure: row for row in drive_rows(Subject("tasks"), [measured(spilled=3, grains=12)])}
    assert "spilled_share" not in without
    assert with_some["spilled_share"].mean == pytest.approx(0.25)


@given(seed=st.integers(0, 10_000), steps=st.integers(1, 40))
def test_no_path_is_shorter_than_the_straight_line(seed, steps):
    position = np.cumsum(np.random.default_rng(seed).normal(size=(steps, 3)), axis=0)
    assert path_length(position) >= np.linalg.norm(position[-1] - position[0]) - 1e-12
    assert path_length(position) == pytest.approx(path_length(position[::-1]))
