from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.figure import draw_trajectories
from latentarm.demonstrations.importers.importing import import_demonstrations
from latentarm.demonstrations.summary import Summary, summarise
from latentarm.demonstrations.validation import validate
from latentarm.robots.limits import JointLimits
from latentarm.robots.planar import planar


def turning() -> Demonstrations:
    """One joint of a one-link arm: still for a second, then half a turn in two seconds."""
    time = np.arange(31) / 10
    angle = np.clip(time - 1, 0, None) * np.pi / 4
    return Demonstrations((Episode(angle[:, None], time, task="turn"),), 10.0, ("joint1",))


def figures(summary: Summary) -> dict[tuple[str, str | None], float]:
    found = {(row.measure, row.condition): row.mean for row in summary.rows() if row.mean is not None}
    assert len(found) == len(summary.rows())
    return found


def test_the_figures_of_a_motion_known_by_hand() -> None:
    robot = planar(1)
    found = figures(summarise(turning(), robot))
    assert found["samples", "episode_0"] == found["samples", None] == 31
    assert found["duration_s", "episode_0"] == found["duration_s", None] == pytest.approx(3.0)
    assert found["rate_hz", "episode_0"] == found["rate_hz", None] == pytest.approx(10.0)
    assert found["path_length_rad", "episode_0"] == pytest.approx(np.pi / 2)
    reach = np.linalg.norm(robot.chain.forward(np.zeros(1)).position)
    assert found["path_length", "episode_0"] == pytest.approx(reach * np.pi / 2, rel=1e-3)
    assert found["still_fraction", "episode_0"] == pytest.approx(1 / 3)
    assert found["speed_max", "joint1"] == found["peak_speed", "episode_0"] == pytest.approx(np.pi / 4)
    assert (found["lowest", "joint1"], found["highest", "joint1"]) == pytest.approx((0, np.pi / 2))
    assert found["limit_margin", "joint1"] == pytest.approx(robot.limits.upper[0] - np.pi / 2)


def test_without_a_robot_limits_are_unknown() -> None:
    summary = summarise(turning())
    assert {"limit_margin", "path_length"}.isdisjoint(measure for measure, _ in figures(summary))
    episodes, joints = summary.tables
    assert dict(zip(episodes.headings(), episodes.lines()[0], strict=True))["tool path (m)"] == "–"
    assert dict(zip(joints.headings(), joints.lines()[0], strict=True))["margin (rad)"] == "–"


def test_tables_and_rows_say_the_same(demonstrations: Demonstrations) -> None:
    summary = summarise(demonstrations)
    episodes, joints = summary.tables
    assert len(episodes.lines()) == 3
    assert len(joints.lines()) == 3
    assert all(len(line) == len(table.headings()) for table in (episodes, joints) for line in table.lines())
    found = figures(summary)
    assert found["episodes", None] == 3
    assert found["samples", "episode_2"] == int(episodes.lines()[2][2]) == 7
    assert f"{found['highest', 'wrist']:.3f}" == joints.lines()[2][2]


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
    *_, gripper = summary.tables
    assert (gripper.title, gripper.lines()) == ("Gripper", [("0", *shown)])
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
        rows = summarise(demonstrations).rows()
        speeds = [row.mean for row in rows if row.measure == "speed_max" and row.mean is not None]
        assert len(speeds) == len(panda_limits.velocity)
        assert np.all(speeds <= panda_limits.velocity)
