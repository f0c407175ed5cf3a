import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.types import Command, Pose, StepRecord
from latentarm.evaluation.summary import Subject
from latentarm_research.metrics.drives import (
    Drive,
    GoalDrive,
    goal_drive_rows,
    measure_goal_drive,
    path_length,
)


def record(time_s, state, u=(0.0, 0.0), mode=0):
    zero = np.zeros(3)
    return StepRecord(
        time_s=time_s,
        state=np.asarray(state, dtype=float),
        input=np.asarray(u, dtype=float),
        latent=np.asarray(u, dtype=float),
        action_human=zero,
        action_assist=zero,
        alpha=0.0,
        belief=np.zeros(0),
        mode=mode,
        command=Command(velocity=zero, duration_s=0.1),
    )


def test_the_figures_of_a_drive_are_those_of_its_record(gantry):
    records = [
        record(1.0, [0, 0, 0], u=(1.0, 0.0)),
        record(1.5, [3, 0, 0], u=(0.6, 0.8), mode=1),
        record(3.5, [3, 4, 0], u=(1.0, 1.0), mode=1),
        record(4.0, [3, 4, 0], mode=0),
    ]
    target = Pose(position=np.array([3.0, 4.0, 2.0]), rotation=np.eye(3))
    elsewhere = Pose(position=np.array([0.0, 0.0, 1.0]), rotation=np.eye(3))
    to_goal = measure_goal_drive(records, gantry, target, [elsewhere, target], success=True)
    drive = to_goal.drive
    assert drive.time_s == pytest.approx(3.0)
    assert drive.idle_s == 0.0
    # 1 m from the other goal, then √10 from it (√20 from the target), then 2 from the target.
    assert to_goal.goal_error_m_s == pytest.approx(0.5 * 1.0 + 2.0 * np.sqrt(10.0) + 0.5 * 2.0)
    assert to_goal.goal_error_m == pytest.approx(to_goal.goal_error_m_s / 3.0)
    assert drive.input_magnitude == pytest.approx(0.5 * 1.0 + 2.0 * 1.0 + 0.5 * np.sqrt(2.0))
    assert drive.mode_switches == 2
    assert drive.path_length == pytest.approx(7.0)
    assert to_goal.final_distance == pytest.approx(2.0)
    assert to_goal.final_angle_deg == 0.0


def test_a_drive_of_one_step_went_nowhere(gantry):
    target = Pose(position=np.zeros(3), rotation=np.eye(3))
    records = [record(2.0, [1, 0, 0], u=(1.0, 0.0))]
    to_goal = measure_goal_drive(records, gantry, target, [target], success=False)
    drive = to_goal.drive
    assert (drive.time_s, drive.input_magnitude, drive.path_length) == (0.0, 0.0, 0.0)
    assert (drive.idle_s, drive.turned_round, to_goal.goal_error_m_s) == (0.0, 0.0, 0.0)
    assert to_goal.goal_error_m == pytest.approx(1.0)
    assert to_goal.final_distance == pytest.approx(1.0)


def test_no_steps_are_no_drive(gantry):
    with pytest.raises(ValueError, match="without a single step"):
        measure_goal_drive([], gantry, Pose(np.zeros(3), np.eye(3)), [], success=False)


def test_rows_hold_mean_sd_and_number_of_a_condition():
    drives = [
        GoalDrive(Drive(True, 4.0, 1.0, 2.0, 0.1, 1, 0.5), 0.8, 0.2, 0.01, 5.0),
        GoalDrive(Drive(False, 8.0, 3.0, 4.0, 0.3, 3, 0.7), 2.4, 0.3, 0.03, 30.0),
    ]
    subject = Subject("drive", task="table", condition="latent")
    rows = {row.measure: row for row in goal_drive_rows(subject, drives)}
    assert rows["success_rate"].mean == 0.5
    assert rows["time_s"].mean == pytest.approx(6.0)
    assert rows["time_s"].sd == pytest.approx(np.std([4.0, 8.0], ddof=1))
    assert rows["mode_switches"].mean == pytest.approx(2.0)
    assert rows["idle_s"].mean == pytest.approx(2.0)
    assert rows["turned_round"].mean == pytest.approx(0.2)
    assert rows["goal_error_m_s"].unit == "m s"
    assert rows["goal_error_m"].mean == pytest.approx(0.25)
    assert {row.n for row in rows.values()} == {2}
    assert {row.condition for row in rows.values()} == {"latent"}
    assert rows["path_length"].unit == rows["final_distance"].unit == "m"


@given(seed=st.integers(0, 10_000), steps=st.integers(1, 40))
def test_no_path_is_shorter_than_the_straight_line(seed, steps):
    position = np.cumsum(np.random.default_rng(seed).normal(size=(steps, 3)), axis=0)
    assert path_length(position) >= np.linalg.norm(position[-1] - position[0]) - 1e-12
    assert path_length(position) == pytest.approx(path_length(position[::-1]))
