from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.figure import draw_trajectories
from latentarm.demonstrations.importing import import_demonstrations
from latentarm.demonstrations.summary import summarise
from latentarm.robots.limits import JointLimits
from latentarm.robots.planar import planar
from latentarm.types import Demonstrations, Episode


def turning() -> Demonstrations:
    """One joint of a one-link arm: still for a second, then half a turn in two seconds."""
    time = np.arange(31) / 10
    angle = np.clip(time - 1, 0, None) * np.pi / 4
    return Demonstrations((Episode(angle[:, None], time, task="turn"),), 10.0, ("joint1",))


def test_the_figures_of_a_motion_known_by_hand() -> None:
    robot = planar(1)
    summary = summarise(turning(), robot)
    (episode,), (joint,) = summary.episodes, summary.joints
    assert (episode.samples, summary.samples) == (31, 31)
    assert episode.duration_s == pytest.approx(3.0)
    assert episode.rate_hz == pytest.approx(10.0)
    assert episode.path_rad == pytest.approx(np.pi / 2)
    reach = np.linalg.norm(robot.chain.forward(np.zeros(1)).position)
    assert episode.path_m == pytest.approx(reach * np.pi / 2, rel=1e-3)
    assert episode.still_fraction == pytest.approx(1 / 3)
    assert joint.speed_max == episode.peak_speed_rad_s == pytest.approx(np.pi / 4)
    assert (joint.lowest, joint.highest) == pytest.approx((0, np.pi / 2))
    assert joint.margin_rad == pytest.approx(robot.limits.upper[0] - np.pi / 2)


def test_without_a_robot_limits_are_unknown() -> None:
    summary = summarise(turning())
    assert summary.joints[0].margin_rad is None
    assert all(row.mean is not None for row in summary.rows())
    assert not [row for row in summary.rows() if row.measure in {"limit_margin", "path_length"}]


def test_tables_and_rows_say_the_same(demonstrations: Demonstrations) -> None:
    summary = summarise(demonstrations)
    episodes, joints = summary.tables()
    assert len(episodes.rows) == 3
    assert len(joints.rows) == 3
    assert all(len(row) == len(table.columns) for table in (episodes, joints) for row in table.rows)
    rows = {(row.measure, row.condition): row.mean for row in summary.rows()}
    assert rows["episodes", None] == 3
    assert rows["samples", "episode_2"] == int(episodes.rows[2][2]) == 7
    assert f"{rows['highest', 'wrist']:.3f}" == joints.rows[2][2]
    assert len(rows) == len(summary.rows())
    assert summary.features == ("action", "assist.alpha", "belief")
    assert summary.goals == ("cup",)


@pytest.mark.parametrize("dof", [1, 2, 7])
def test_the_figure_is_a_picture(tmp_path: Path, panda_limits: JointLimits, dof: int) -> None:
    states = np.linspace(-0.5, 0.5, 20)[:, None] * np.ones(dof)
    one = Demonstrations((Episode(states, np.arange(20) / 10),), 10.0, tuple("abcdefg"[:dof]))
    part = {name: getattr(panda_limits, name)[:dof] for name in ("lower", "upper", "velocity")}
    limits = JointLimits(**part, acceleration=np.ones(dof), jerk=np.ones(dof))
    draw_trajectories(one, tmp_path / "with.png", limits)
    draw_trajectories(one, tmp_path / "without.png")
    for path in tmp_path.iterdir():
        assert path.read_bytes().startswith(b"\x89PNG")
    assert len(list(tmp_path.iterdir())) == 2


def test_the_real_recordings_are_within_the_pandas_limits(real: Path, panda_limits: JointLimits) -> None:
    for name in ("panda_pick_banana", "panda_pick_cereal", "panda_pour_coffee"):
        demonstrations = import_demonstrations(real / f"{name}.npz")
        states = np.concatenate([episode.state for episode in demonstrations.episodes])
        assert panda_limits.violation(states).max() == 0
        speeds = [joint.speed_max for joint in summarise(demonstrations).joints]
        assert np.all(speeds <= panda_limits.velocity)
