from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.figure import draw_trajectories
from latentarm.demonstrations.importers.importing import import_demonstrations
from latentarm.demonstrations.summary import summarise
from latentarm.demonstrations.validation import validate
from latentarm.robots.limits import JointLimits
from latentarm.robots.planar import planar


def turning() -> Demonstrations:
    """One joint of a one-link arm: still for a second, then half a turn in two seconds."""
    time = np.arange(31) / 10
    angle = np.clip(time - 1, 0, None) * np.pi / 4
    return Demonstrations((Episode(angle[:, None], time, task="turn"),), 10.0, ("joint1",))


def test_the_figures_of_a_motion_known_by_hand() -> None:
    robot = planar(1)
    summary = summarise(turning(), robot)
    (episode,), (joint,) = summary.episodes, summary.joints
    assert episode.samples == 31
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


def with_gripper(feature: str, values: list[float], **others: list[float]) -> Demonstrations:
    """Five samples over two seconds."""
    extras = {name: np.array(one)[:, None] for name, one in {feature: values, **others}.items()}
    time = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    return Demonstrations((Episode(np.arange(5.0)[:, None] / 10, time, extras=extras),), 2.0, ("joint1",))


@pytest.mark.parametrize(
    ("feature", "values", "others", "shown"),
    [
        ("observation.gripper_width", [0.08, 0.08, 0.01, 0.01, 0.08], {}, ("50", "–", "2")),
        # Closed round something wide: what it was told says so, or that it holds.
        (
            "observation.gripper_width",
            [0.08, 0.06, 0.06, 0.06, 0.08],
            {"action.gripper": [0.0, 0.0, 0.0, 0.08, 0.08]},
            ("75", "–", "1"),
        ),
        (
            "observation.gripper_width",
            [0.08, 0.06, 0.06, 0.06, 0.08],
            {"observation.gripper_holding": [0.0, 1.0, 1.0, 1.0, 0.0]},
            ("75", "–", "2"),
        ),
        ("observation.gripper_opening", [0.2, 0.3, 0.3, 0.2, 0.3], {}, ("100", "–", "0")),
        ("observation.gripper_toggled", [0.0, 1.0, 0.0, 0.0, 1.0], {}, ("–", "25", "3")),
    ],
)
def test_what_a_gripper_did_is_counted(
    feature: str, values: list[float], others: dict[str, list[float]], shown: tuple[str, ...]
) -> None:
    demonstrations = with_gripper(feature, values, **others)
    validate(demonstrations, "here")
    summary = summarise(demonstrations)
    *_, gripper = summary.tables()
    assert (gripper.title, gripper.rows) == ("Gripper", (("0", *shown),))
    rows = {row.measure: row.mean for row in summary.rows()}
    assert rows["gripper_changes"] == int(shown[2])


@pytest.mark.parametrize(
    ("feature", "value"),
    [
        ("observation.gripper_width", -0.01),
        ("observation.gripper_width", 80.0),
        ("observation.gripper_width", np.nan),
        ("observation.gripper_holding", 0.5),
        ("observation.gripper_toggled", 2.0),
    ],
)
def test_a_gripper_that_cannot_be_is_refused(feature: str, value: float) -> None:
    with pytest.raises(UserError, match=rf"here: episode 0, sample 3: {feature}\[0\] is"):
        validate(with_gripper(feature, [0.0, 0.0, 1.0, value, 0.0]), "here")


@pytest.mark.parametrize("dof", [1, 2])
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
