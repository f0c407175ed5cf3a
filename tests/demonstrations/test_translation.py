"""Other people's columns and units: told apart, turned into rad, written down, or refused."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.importers.columns import find_columns
from latentarm.demonstrations.importers.importing import import_demonstrations, import_to
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.robot_names import may_be
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot

MOTORS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
NAMES = tuple(f"{motor}.pos" for motor in MOTORS)
FRAMES = 20


def recorded(scale: float = 1.0) -> np.ndarray:
    """(T, 6), as a LeRobot SO-101 records: five joints about their middles, the gripper from 0 to 100."""
    phase = np.linspace(0.0, 1.0, FRAMES)[:, None]
    joints = scale * np.array([[30.0, -40.0, 20.0, 10.0, -50.0]]) * np.sin(np.pi * phase)
    return np.concatenate([joints, 100.0 * phase], axis=1).astype(np.float32)


def v3(
    folder: Path, states: np.ndarray, names: tuple[str, ...] = NAMES, robot: str = "so101_follower"
) -> Path:
    """A LeRobot v3.0 dataset of two episodes, whose actions are a tenth of a degree ahead."""
    one = Episode(states, np.arange(len(states)) / 30, states + 0.1, task="pick")
    write_dataset(Demonstrations((one, one), 30.0, names, robot), folder)
    path = folder / "meta/info.json"
    document = json.loads(path.read_text())
    del document["latentarm"]
    path.write_text(json.dumps(document))
    return folder


def v21(folder: Path, states: np.ndarray) -> Path:
    """The same in the v2.1 layout: a file for each episode, lists as JSON lines."""
    vector = {"dtype": "float32", "shape": [6], "names": list(NAMES)}
    (folder / "meta").mkdir(parents=True)
    (folder / "data/chunk-000").mkdir(parents=True)
    info = {
        "codebase_version": "v2.1",
        "robot_type": "so101_follower",
        "total_episodes": 2,
        "total_frames": 2 * len(states),
        "total_tasks": 1,
        "total_videos": 0,
        "total_chunks": 1,
        "chunks_size": 1000,
        "fps": 30,
        "splits": {"train": "0:2"},
        "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "video_path": None,
        "features": {"action": vector, "observation.state": vector},
    }
    (folder / "meta/info.json").write_text(json.dumps(info))
    (folder / "meta/tasks.jsonl").write_text(json.dumps({"task_index": 0, "task": "pick"}) + "\n")
    lines = [
        json.dumps({"episode_index": index, "tasks": ["pick"], "length": len(states)}) for index in range(2)
    ]
    (folder / "meta/episodes.jsonl").write_text("\n".join(lines) + "\n")
    for index in range(2):
        count = len(states)
        columns = {
            "action": pa.FixedSizeListArray.from_arrays(pa.array((states + 0.1).ravel()), 6),
            "observation.state": pa.FixedSizeListArray.from_arrays(pa.array(states.ravel()), 6),
            "timestamp": pa.array((np.arange(count) / 30).astype(np.float32)),
            "frame_index": pa.array(np.arange(count)),
            "episode_index": pa.array(np.full(count, index)),
            "index": pa.array(index * count + np.arange(count)),
            "task_index": pa.array(np.zeros(count, dtype=np.int64)),
        }
        pq.write_table(pa.table(columns), folder / f"data/chunk-000/episode_{index:06d}.parquet")
    return folder


@pytest.mark.parametrize("layout", [v3, v21])
def test_an_so101_dataset_in_degrees(
    tmp_path: Path, so101: Robot, layout: Callable[[Path, np.ndarray], Path]
) -> None:
    states = recorded()
    source = layout(tmp_path / "theirs", states)
    with pytest.raises(UserError, match=r"does not say its units.*--units deg.*--units normalized"):
        import_demonstrations(source, so101)
    import_to(source, tmp_path / "ours", so101, ImportOptions(units=("deg",)))
    found = read_dataset(tmp_path / "ours")
    first = found.episodes[1]
    assert found.joint_names == MOTORS[:5]
    assert first.task == "pick"
    assert first.action is None
    np.testing.assert_allclose(first.state, np.deg2rad(states[:, :5]), atol=1e-6)
    np.testing.assert_allclose(first.extras["observation.gripper_opening"], states[:, 5:] / 100, atol=1e-6)
    target = first.extras["action.target_position"]
    np.testing.assert_allclose(target, np.deg2rad(states[:, :5] + 0.1), atol=1e-6)
    np.testing.assert_allclose(first.extras["action.gripper"], (states[:, 5:] + 0.1) / 100, atol=1e-6)
    record = found.import_record
    assert record["recorded on"] == "so101_follower"
    assert "elbow_flex = elbow_flex.pos" in record["joints"]
    assert "deg (as told)" in record["units"]
    assert "gripper.pos" in record["gripper"]
    assert "target positions" in record["actions"]


def test_normalized_positions_run_over_the_joints_ranges(tmp_path: Path, so101: Robot) -> None:
    states = np.zeros((FRAMES, 6), dtype=np.float32)
    states[:, 0] = np.linspace(-100, 100, FRAMES)
    states[:, 4] = np.linspace(-50, 50, FRAMES)
    found = import_demonstrations(
        v3(tmp_path / "theirs", states), so101, ImportOptions(units=("normalized",))
    )
    state = found.episodes[0].state
    np.testing.assert_allclose(state[[0, -1], 0], [-1.91986, 1.91986], atol=1e-6)
    np.testing.assert_allclose(state[[0, -1], 4], [-np.pi / 2, np.pi / 2], atol=1e-6)  # a full turn
    assert "is assumed" in found.import_record["units"]
    mixed = import_demonstrations(
        tmp_path / "theirs", so101, ImportOptions(units=("normalized", "wrist_roll=deg"))
    )
    np.testing.assert_allclose(mixed.episodes[0].state[-1, 4], np.deg2rad(50), atol=1e-6)


def test_an_so101_dataset_is_not_taken_for_another_arm(tmp_path: Path) -> None:
    source = v3(tmp_path / "theirs", recorded())
    with pytest.raises(UserError, match=r"recorded on 'so101_follower', and the robot is panda.*--robot"):
        import_demonstrations(source, panda(), ImportOptions(units=("deg",)))
    with pytest.raises(UserError, match=r"have 5 joints .* but the robot has 7"):
        import_demonstrations(source, panda(), ImportOptions(units=("deg",), recorded_on="so101_follower"))


def test_a_robomimic_file_of_another_arm_is_refused(tmp_path: Path) -> None:
    arguments = {"env_name": "Lift", "env_kwargs": {"control_freq": 20, "robots": ["IIWA"]}}
    with h5py.File(tmp_path / "demo.hdf5", "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps(arguments)
        data["demo_0/obs/robot0_joint_pos"] = panda().home + 0.01 * np.arange(9)[:, None]
    with pytest.raises(UserError, match="recorded on 'IIWA', and the robot is panda"):
        import_demonstrations(tmp_path / "demo.hdf5", panda())
    found = import_demonstrations(tmp_path / "demo.hdf5", panda(), ImportOptions(recorded_on="IIWA"))
    assert found.import_record["recorded on"] == "IIWA"


def test_old_lerobot_columns_are_refused_for_their_other_zero(tmp_path: Path, so101: Robot) -> None:
    names = tuple(f"main_{motor}" for motor in MOTORS)
    source = v3(tmp_path / "theirs", recorded(), names, robot="so100")
    with pytest.raises(UserError, match="zero was the arm stretched out"):
        import_demonstrations(source, so101, ImportOptions(units=("deg",), recorded_on="so100"))


def test_a_little_outside_the_limits_can_be_clipped(tmp_path: Path, so101: Robot) -> None:
    states = recorded()
    states[:, 1] = -104.0  # the stop of this arm; the model says -100
    source = v3(tmp_path / "theirs", states)
    with pytest.raises(UserError, match=r"shoulder_lift is at -1.8151 rad, below .*--clip-rad 0.07"):
        import_demonstrations(source, so101, ImportOptions(units=("deg",)))
    found = import_demonstrations(source, so101, ImportOptions(units=("deg",), clip_rad=0.1))
    np.testing.assert_allclose(found.episodes[0].state[:, 1], -1.74533)
    assert "40 samples were up to 0.070 rad outside" in found.import_record["clipped"]


def test_speeds_beyond_the_limits_are_said(tmp_path: Path, so101: Robot) -> None:
    found = import_demonstrations(
        v3(tmp_path / "theirs", recorded(2.0)), so101, ImportOptions(units=("deg",))
    )
    assert "its assumed limit is 1.00 rad/s" in found.import_record["warning"]


def test_radians_that_are_called_degrees_are_said(tmp_path: Path, so101: Robot) -> None:
    found = import_demonstrations(
        v3(tmp_path / "theirs", recorded(np.pi / 180)), so101, ImportOptions(units=("deg",))
    )
    assert "look like rad" in found.import_record["warning"]


def test_csv_with_a_robot_and_a_gripper(tmp_path: Path) -> None:
    arm = panda()
    names = [f"panda_joint{joint + 1}" for joint in reversed(range(7))]
    lines = [
        ",".join(["0", f"{0.1 * tick}", "Panda", *map(str, arm.home[::-1]), str(0.01 * tick)])
        for tick in range(5)
    ]
    header = ",".join(["episode", "timestamp", "robot", *names, "gripper"])
    (tmp_path / "table.csv").write_text("\n".join([header, *lines]))
    found = import_demonstrations(tmp_path / "table.csv", arm)
    np.testing.assert_allclose(found.episodes[0].state[0], arm.home)
    np.testing.assert_allclose(found.episodes[0].extras["observation.gripper"][:, 0], 0.01 * np.arange(5))
    assert "though spelled differently" in found.import_record["joints"]


@given(st.permutations(range(6)), st.sampled_from(["{}", "{}.pos", "Robot0-{}_Pos", "left {}"]))
def test_columns_are_found_in_any_order_and_spelling(order: list[int], spelling: str) -> None:
    names = [spelling.format(MOTORS[index]) for index in order]
    found = find_columns(names, MOTORS[:5], (), None, "here")
    assert [order[column] for column in found.joints] == [0, 1, 2, 3, 4]
    assert found.gripper is not None
    assert order[found.gripper] == 5


@pytest.mark.parametrize(
    ("told", "columns"),
    [
        (("b", "a"), (1, 0)),
        (("1", "0"), (1, 0)),
        (("shoulder=b", "elbow=0"), (1, 0)),
    ],
)
def test_columns_can_be_told(told: tuple[str, ...], columns: tuple[int, ...]) -> None:
    found = find_columns(["a", "b", "c"], ["shoulder", "elbow"], told, "c", "here")
    assert (found.joints, found.gripper, found.dropped) == (columns, 2, ())


def test_a_column_that_is_called_a_width_is_one(tmp_path: Path) -> None:
    header = ",".join(["episode", "timestamp", *panda().joint_names, "gripper_width"])
    for name, width in (("m", 0.04), ("mm", 40.0)):
        lines = [f"0,{0.1 * row},{','.join(map(str, panda().home))},{width}" for row in range(5)]
        (tmp_path / f"{name}.csv").write_text("\n".join([header, *lines]))
    found = import_demonstrations(tmp_path / "m.csv", panda())
    np.testing.assert_array_equal(
        found.episodes[0].extras["observation.gripper_width"], np.full((5, 1), 0.04)
    )
    assert (
        found.import_record["gripper"] == "gripper_width, stored as observation.gripper_width, m by its name"
    )
    with pytest.raises(UserError, match=r"gripper_width\[0\] is 40; an opening is from 0 to 1 m"):
        import_demonstrations(tmp_path / "mm.csv", panda())


@pytest.mark.parametrize(
    ("told", "gripper", "said"),
    [
        ((), None, "cannot be matched to the robot's joints shoulder, elbow.*--joints a b"),
        (("a",), None, "must name 2 columns"),
        (("a", "a"), None, "for more than one joint"),
        (("a", "d"), None, "no column 'd'; it has a, b, c"),
        (("shoulder=a", "wrist=b"), None, "shoulder=COLUMN elbow=COLUMN"),
        (("a", "b"), "b", "cannot be both gripper and joint"),
    ],
)
def test_columns_that_cannot_be_known_are_refused(
    told: tuple[str, ...], gripper: str | None, said: str
) -> None:
    with pytest.raises(UserError, match=said):
        find_columns(["a", "b", "c"], ["shoulder", "elbow"], told, gripper, "here")


@pytest.mark.parametrize(
    ("named", "path", "fits"),
    [
        ("so101_follower", "/models/so101_new_calib.urdf", True),
        ("so101", "/models/SO-101/robot.xml", True),
        ("UR5e", "/models/universal_robots_ur5e/scene.xml", True),
        ("UR5", "/models/ur5e.urdf", False),
        ("Panda", "panda", True),
        ("franka_panda", "panda", True),
        ("UR5e", "panda", False),
        ("so101_follower", "/models/ur5e.urdf", False),
    ],
)
def test_whether_a_file_means_this_robot(named: str, path: str, fits: bool) -> None:
    assert may_be(named, replace(panda(), name=path, mjcf="")) is fits
