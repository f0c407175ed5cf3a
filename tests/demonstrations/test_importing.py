import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.importers.importing import import_demonstrations, import_to
from latentarm.demonstrations.importers.npz_file import read_npz
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.info import INFO_PATH
from latentarm.demonstrations.validation import LIMIT_TOLERANCE_RAD, validate
from latentarm.robots.limits import JointLimits
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar

Equal = Callable[[Demonstrations, Demonstrations], bool]

WIDE = 0.08
"""Largest opening of the Panda's hand, m."""

FILES = {"panda_pick_banana": 5938, "panda_pick_cereal": 4689, "panda_pour_coffee": 4252}


@pytest.mark.parametrize("name", FILES)
def test_the_real_recordings_import_whole(real: Path, tmp_path: Path, name: str) -> None:
    robot = panda()
    import_to(real / f"{name}.npz", tmp_path / "data", robot)
    demonstrations = read_dataset(tmp_path / "data")
    assert len(demonstrations.episodes) == 15
    assert (demonstrations.rate_hz, demonstrations.robot) == (10.0, "panda")
    assert demonstrations.joint_names == robot.joint_names
    with np.load(real / f"{name}.npz", allow_pickle=False) as arrays:
        for key, values in (
            ("q", [episode.state for episode in demonstrations.episodes]),
            ("dq", [episode.extras["observation.velocity"] for episode in demonstrations.episodes]),
            ("tau", [episode.extras["observation.effort"] for episode in demonstrations.episodes]),
        ):
            np.testing.assert_array_equal(np.concatenate(values), arrays[key].astype(np.float32))
            assert len(np.concatenate(values)) == FILES[name]
        toggles, first = arrays["gripper_toggles"], 0
    for episode in demonstrations.episodes:
        width, told = (episode.extras[key][:, 0] for key in ("observation.gripper_width", "action.gripper"))
        inside = toggles[(toggles >= first) & (toggles < first + len(width))] - first
        # Open at first, and the other way after each toggle, where it is told so.
        np.testing.assert_array_equal(np.flatnonzero(np.diff(width)), inside)
        np.testing.assert_array_equal(told[:-1], width[1:])
        assert set(width) == {np.float32(0.08)} | ({0.0} if len(inside) else set())
        assert (width[0], "observation.gripper_toggled" in episode.extras) == (np.float32(0.08), False)
        first += len(width)
    said = demonstrations.import_record["gripper"]
    assert f"opened or closed {len(toggles)} times" in said if len(toggles) else "never toggled" in said
    assert "assumed" in said
    assert "commanded, not measured" in said
    assert all(episode.action is None for episode in demonstrations.episodes)


def test_a_state_may_pass_a_limit_by_no_more_than_the_tolerance(panda_limits: JointLimits) -> None:
    def at(state: np.ndarray) -> Demonstrations:
        states = np.tile(state, (2, 1))
        return Demonstrations((Episode(states, np.arange(2.0)),), 1.0, tuple("abcdefg"))

    validate(at(panda_limits.upper + 0.99 * LIMIT_TOLERANCE_RAD), "here", panda_limits)
    validate(at(panda_limits.lower - 0.99 * LIMIT_TOLERANCE_RAD), "here", panda_limits)
    with pytest.raises(
        UserError, match=r"here: episode 0, sample 0: joint a is at 2\.9083 rad, above its upper"
    ):
        validate(at(panda_limits.upper + 1.1 * LIMIT_TOLERANCE_RAD), "here", panda_limits)


@pytest.mark.parametrize(
    ("toggles", "state"),
    [
        ([2], [0, 0, 0, 1, 1, 1, 0, 0, 0, 0]),
        ([1, 4], [0, 0, 1, 1, 1, 0, 0, 0, 0, 0]),
        ([4, 1, 7], [0, 0, 1, 1, 1, 0, 0, 0, 1, 1]),
        ([5, 6], [0, 0, 0, 0, 0, 0, 0, 1, 1, 1]),  # the first comes after its episode's last sample
        ([3, 3], [0] * 10),  # there and back between two samples
        ([9], [0] * 10),
    ],
)
def test_toggles_of_a_gripper_become_its_state(tmp_path: Path, toggles: list[int], state: list[int]) -> None:
    q = np.linspace(0.0, 0.1, 70).reshape(10, 7) + panda().home
    np.savez(tmp_path / "a.npz", q=q, episode_ends=[6, 10], rate_hz=10.0, gripper_toggles=toggles)
    episodes = read_npz(tmp_path / "a.npz", ImportOptions()).demonstrations.episodes
    found = np.concatenate([episode.extras["observation.gripper_toggled"] for episode in episodes])
    assert found.ravel().tolist() == state


def test_arrays_that_are_not_used_are_named_and_never_opened(tmp_path: Path) -> None:
    q = np.linspace(0.0, 0.1, 70).reshape(10, 7) + panda().home
    notes = np.array([{}], dtype=object)
    np.savez(tmp_path / "a.npz", q=q, episode_ends=[10], rate_hz=10.0, person=["ada"], notes=notes)
    record = import_demonstrations(tmp_path / "a.npz", panda()).import_record
    assert record["arrays left out"] == "person, notes"


def test_a_gripper_starts_as_it_is_said_to(tmp_path: Path) -> None:
    q = np.linspace(0.0, 0.1, 70).reshape(10, 7) + panda().home
    arrays = {"q": q, "episode_ends": [6, 10], "rate_hz": 10.0}
    np.savez(tmp_path / "a.npz", **arrays, gripper_toggles=[3])
    closed = import_demonstrations(tmp_path / "a.npz", panda(), ImportOptions(gripper_starts="closed"))
    widths = np.concatenate([one.extras["observation.gripper_width"] for one in closed.episodes])
    np.testing.assert_array_equal(widths.ravel(), [0, 0, 0, 0, 0.08, 0.08, 0, 0, 0, 0])
    assert "closed when an episode begins (as told)" in closed.import_record["gripper"]
    # A dataset from before, with toggles, becomes one with widths when it is imported again.
    import_to(tmp_path / "a.npz", tmp_path / "old")
    again = import_demonstrations(tmp_path / "old", panda(), ImportOptions(recorded_on=""))
    assert again.episodes[0].extras["action.gripper"].ravel().tolist() == [WIDE] * 3 + [0.0] * 3
    with pytest.raises(UserError, match="the robot has no gripper: leave it out"):
        import_demonstrations(tmp_path / "a.npz", planar(7), ImportOptions(gripper_starts="open"))
    np.savez(tmp_path / "b.npz", **arrays)
    with pytest.raises(UserError, match=r"b.npz does not say when it was toggled"):
        import_demonstrations(tmp_path / "b.npz", panda(), ImportOptions(gripper_starts="open"))


def test_npz_actions_and_times_are_kept(tmp_path: Path) -> None:
    q, action = np.arange(12.0).reshape(6, 2) / 10, np.ones((6, 2))
    time = np.array([5.0, 5.1, 5.3, 9.0, 9.1, 9.2])
    np.savez(tmp_path / "s.npz", q=q, episode_ends=[3, 6], rate_hz=10.0, timestamp=time, action=action)
    first, second = import_demonstrations(
        tmp_path / "s.npz", options=ImportOptions(instruction="wave")
    ).episodes
    np.testing.assert_allclose(first.timestamp, [0.0, 0.1, 0.3])
    np.testing.assert_allclose(second.timestamp, [0.0, 0.1, 0.2])
    np.testing.assert_array_equal(second.action, action[3:])
    np.testing.assert_array_equal(second.state, q[3:])
    assert second.task == "wave"


def test_a_rate_that_is_given_counts(tmp_path: Path) -> None:
    np.savez(tmp_path / "s.npz", q=np.zeros((4, 2)), episode_ends=[4])
    (episode,) = import_demonstrations(tmp_path / "s.npz", options=ImportOptions(rate_hz=20.0)).episodes
    np.testing.assert_allclose(episode.timestamp, [0.0, 0.05, 0.1, 0.15])
    with pytest.raises(UserError, match="rate is -1 Hz"):
        import_demonstrations(tmp_path / "s.npz", options=ImportOptions(rate_hz=-1.0))


CSV = """episode,timestamp,elbow,shoulder,task,action.elbow,action.shoulder
a,100.0,0.1,0.5,reach,1,5
a,100.1,0.2,0.6,reach,2,6
b,7.0,0.3,0.7,stab,3,7
b,7.1,0.4,0.8,stab,4,8
b,7.2,0.5,0.9,stab,5,9
"""


def test_csv_columns_are_found_by_name(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(CSV, encoding="utf-8-sig")
    demonstrations = import_demonstrations(tmp_path / "table.csv")
    first, second = demonstrations.episodes
    assert demonstrations.joint_names == ("elbow", "shoulder")
    assert demonstrations.rate_hz == 10.0
    assert (first.task, second.task) == ("reach", "stab")
    np.testing.assert_allclose(first.state, [[0.1, 0.5], [0.2, 0.6]])
    np.testing.assert_allclose(second.action, [[3, 7], [4, 8], [5, 9]])
    np.testing.assert_allclose(second.timestamp, [0.0, 0.1, 0.2])


def test_csv_columns_follow_the_robot(tmp_path: Path) -> None:
    robot = planar()
    names = list(reversed(robot.joint_names))
    rows = [f"0,{time},9,{','.join(str(index / 10) for index in range(robot.dof))}" for time in (0, 0.1)]
    header = f"episode,timestamp,temperature,{','.join(names)}"
    (tmp_path / "table.csv").write_text("\n".join([header, *rows]))
    (episode,) = import_demonstrations(tmp_path / "table.csv", robot).episodes
    np.testing.assert_allclose(episode.state[0], [index / 10 for index in reversed(range(robot.dof))])


def robomimic(path: Path, key: str = "robot0_joint_pos", controller: dict[str, object] | None = None) -> Path:
    arguments = {"env_name": "Lift", "env_kwargs": {"control_freq": 20, "controller_configs": controller}}
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps(arguments)
        for demo in (0, 2, 10):
            data[f"demo_{demo}/obs/{key}"] = np.full((4, 7), demo / 10) + np.arange(4)[:, None]
            data[f"demo_{demo}/actions"] = np.full((4, 8), 0.5)
    return path


@pytest.mark.parametrize("key", ["robot0_joint_pos", "joint_states"])
def test_robomimic_demos_come_in_order(tmp_path: Path, key: str) -> None:
    demonstrations = import_demonstrations(robomimic(tmp_path / "demo.hdf5", key))
    assert [episode.state[0, 0] for episode in demonstrations.episodes] == [0.0, 0.2, 1.0]
    assert demonstrations.rate_hz == 20.0
    np.testing.assert_allclose(demonstrations.episodes[0].timestamp, [0.0, 0.05, 0.1, 0.15])
    assert demonstrations.episodes[0].task == "Lift"


VELOCITY = {"type": "JOINT_VELOCITY", "input_max": 1, "output_max": 0.4}


@pytest.mark.parametrize(
    ("controller", "speed"),
    [
        ({"type": "OSC_POSE", "input_max": 1, "output_max": 0.05}, None),
        (None, None),
        (VELOCITY, 0.2),
        ({"type": "BASIC", "body_parts": {"right": VELOCITY}}, 0.2),
    ],
)
def test_robomimic_actions_count_only_as_joint_velocities(
    tmp_path: Path, controller: dict[str, object] | None, speed: float | None
) -> None:
    source = robomimic(tmp_path / "demo.hdf5", controller=controller)
    action = import_demonstrations(source).episodes[0].action
    if speed is None:
        assert action is None
    else:
        np.testing.assert_allclose(action, np.full((4, 7), speed))
    vouched = (
        import_demonstrations(source, options=ImportOptions(actions="joint_velocity")).episodes[0].action
    )
    np.testing.assert_array_equal(vouched, np.full((4, 7), 0.5))


def test_robomimic_two_arms_are_one_state(tmp_path: Path) -> None:
    source = robomimic(tmp_path / "demo.hdf5")
    with h5py.File(source, "a") as file:
        for demo in (0, 2, 10):
            file[f"data/demo_{demo}/obs/robot1_joint_pos"] = np.ones((4, 7))
    state = import_demonstrations(source).episodes[0].state
    assert state.shape == (4, 14)
    assert np.all(state[:, 7:] == 1)


def with_a_gripper(path: Path, robot: str, key: str, **keywords: object) -> Path:
    """A file of robosuite with a gripper that closes from its second sample on."""
    robomimic(path)
    with h5py.File(path, "a") as file:
        arguments = {"env_kwargs": {"control_freq": 20, "robots": [robot], **keywords}}
        file["data"].attrs["env_args"] = json.dumps(arguments)
        for demo in (0, 2, 10):
            file[f"data/demo_{demo}/obs/robot0_joint_pos"][:] = panda().home + 0.01 * np.arange(4)[:, None]
            finger = np.array([0.04, 0.03, 0.02, -1e-5])
            file[f"data/demo_{demo}/obs/{key}"] = np.stack([finger, -finger], axis=1)
            file[f"data/demo_{demo}/actions"][:, -1] = [0.0, 1.0, 0.0, -1.0]
    return path


@pytest.mark.parametrize("key", ["robot0_gripper_qpos", "gripper_states"])
def test_robomimic_s_panda_has_an_opening_and_where_it_goes(tmp_path: Path, key: str) -> None:
    source = with_a_gripper(tmp_path / "demo.hdf5", "Panda", key, gripper_types="default")
    import_to(source, tmp_path / "data", panda())
    demonstrations = read_dataset(tmp_path / "data")
    extras = demonstrations.episodes[1].extras
    np.testing.assert_allclose(extras["observation.gripper_width"].ravel(), [0.08, 0.06, 0.04, 0.0])
    np.testing.assert_allclose(extras["action.gripper"].ravel(), [0.08, 0.0, 0.0, 0.08])
    assert demonstrations.import_record["gripper"] == "observation.gripper_width"


@pytest.mark.parametrize(
    ("robot", "keywords"), [("Sawyer", {}), ("Panda", {"gripper_types": ["Robotiq85Gripper"]})]
)
def test_robomimic_s_other_grippers_stay_as_recorded(
    tmp_path: Path, robot: str, keywords: dict[str, object]
) -> None:
    source = with_a_gripper(tmp_path / "demo.hdf5", robot, "robot0_gripper_qpos", **keywords)
    extras = import_demonstrations(source).episodes[0].extras
    assert set(extras) == {"observation.gripper"}
    assert extras["observation.gripper"].shape == (4, 2)


def test_a_dataset_of_ours_imports_with_everything(
    tmp_path: Path, demonstrations: Demonstrations, equal: Equal
) -> None:
    write_dataset(demonstrations, tmp_path / "ours")
    assert equal(import_demonstrations(tmp_path / "ours"), demonstrations)


def test_a_foreign_dataset_is_imported_without_its_actions(
    tmp_path: Path, demonstrations: Demonstrations
) -> None:
    """The layout does not say what an action is; only the caller can."""
    write_dataset(demonstrations, tmp_path / "theirs")
    path = tmp_path / "theirs" / INFO_PATH
    document = json.loads(path.read_text())
    del document["latentarm"]
    document["features"]["observation.state"]["names"] = {"motors": ["m1", "m2", "m3"]}
    document["features"]["observation.images.top"] = {"dtype": "video", "shape": [480, 640, 3], "names": None}
    path.write_text(json.dumps(document))
    with pytest.raises(UserError, match="written by another program; import it"):
        read_dataset(tmp_path / "theirs")
    known = import_demonstrations(tmp_path / "theirs")
    assert known.joint_names == ("m1", "m2", "m3")
    assert all(episode.action is None for episode in known.episodes)
    vouched = import_demonstrations(tmp_path / "theirs", options=ImportOptions(actions="joint_velocity"))
    np.testing.assert_allclose(vouched.episodes[2].action, demonstrations.episodes[2].action, rtol=1e-6)


def test_joints_in_another_order_are_put_into_the_robots(tmp_path: Path) -> None:
    robot = planar(3)
    names = tuple(reversed(robot.joint_names))
    states = np.tile([0.3, 0.2, 0.1], (2, 1))
    write_dataset(Demonstrations((Episode(states, np.arange(2.0)),), 1.0, names), tmp_path / "data")
    imported = import_demonstrations(tmp_path / "data", robot)
    assert imported.joint_names == robot.joint_names
    np.testing.assert_allclose(imported.episodes[0].state[0], [0.1, 0.2, 0.3], rtol=1e-6)
    assert "by name" in imported.import_record["joints"]
