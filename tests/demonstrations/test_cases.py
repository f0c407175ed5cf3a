"""Recordings as people have them: they wrap, pause, change their rate, and come in any dialect and folder."""

import gzip
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags import joint_state_bag
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.demonstrations.importers.importing import import_demonstrations, import_to
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.robots.catalogue import load_robot
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot

SHARED = Path(__file__).resolve().parents[3] / "shared" / "cases"

SPINNER = """<mujoco model="spinner"><compiler angle="radian"/><worldbody>
<body pos="0 0 .1"><joint name="base" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0 0 .1" size=".03"/>
<body pos="0 0 .1"><joint name="elbow" axis="0 1 0" range="-2 2"/>
<geom type="capsule" fromto="0 0 0 0 0 .1" size=".03"/>
<body pos="0 0 .1"><joint name="wrist" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0 0 .1" size=".03"/>
<site name="tool" pos="0 0 .1"/></body></body></body></worldbody></mujoco>"""
"""An arm whose base and wrist turn without stops."""

JOINTS = ("base", "elbow", "wrist")
T = 60
TIMES = np.arange(T) / 20
WAY = np.stack([np.linspace(2.0, 5.0, T), np.linspace(-1, 1, T), np.linspace(0, -4, T)], axis=1)
TURN = 2 * np.pi


@pytest.fixture(scope="module")
def spinner(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    path = tmp_path_factory.mktemp("robot") / "spinner.xml"
    path.write_text(SPINNER)
    return load_robot(str(path))


def table(
    path: Path,
    *episodes: tuple[np.ndarray, np.ndarray],
    names: Sequence[str] = JOINTS,
    separator: str = ",",
    decimal: str = ".",
    labels: str | None = "abcdef",
) -> Path:
    """A CSV file of episodes, each its times and its states."""
    lines = [["episode", "timestamp", *names] if labels else ["timestamp", *names]]
    for index, (times, states) in enumerate(episodes):
        for time, state in zip(times, states, strict=True):
            numbers = [f"{value:.9f}".rstrip("0").replace(".", decimal) for value in state]
            stamp = repr(time.item()).replace(".", decimal)
            lines.append([labels[index], stamp, *numbers] if labels else [stamp, *numbers])
    path.write_text("\n".join(map(separator.join, lines)))
    return path


def one_way(found: Demonstrations, way: np.ndarray = WAY) -> None:
    """Each episode is the way that was made, but for whole turns of the whole episode."""
    for episode in found.episodes:
        off = (episode.state - way) / TURN
        np.testing.assert_allclose(off - np.round(off), 0, atol=1e-6)
        np.testing.assert_allclose(off - off[0], 0, atol=1e-6)


WRAPPED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "at half a turn": lambda way: (way + np.pi) % TURN - np.pi,
    "at a whole turn": lambda way: way % TURN,
    "counting turns": lambda way: way + np.array([16, 0, -9]) * TURN,
}


@pytest.mark.parametrize("how", WRAPPED)
def test_joints_without_stops_are_unwrapped(tmp_path: Path, spinner: Robot, how: str) -> None:
    states = WRAPPED[how](WAY)
    states[:, 1] = WAY[:, 1]
    found = import_demonstrations(table(tmp_path / "a.csv", (TIMES, states), (TIMES, states + 1e-9)), spinner)
    one_way(found)
    first, second = found.episodes
    assert np.abs(first.state[0, [0, 2]]).max() <= np.pi + 1e-6
    assert np.abs(second.state - first.state).max() < 1e-6
    said = found.import_record["turns"]
    assert "wrist" in said
    assert "elbow" not in said
    assert ("counts turns" if how == "counting turns" else "wraps") in said


def test_episodes_that_wrapped_apart_lie_together(tmp_path: Path, spinner: Robot) -> None:
    """One begins just below half a turn and one just above, and one has counted three turns more."""
    ways = [0.3 * WAY + [begin - 0.6, 0, 0] for begin in (3.0, 3.3, 3.1 + 3 * TURN)]
    wrapped = [
        (TIMES, np.concatenate([(way[:, :1] + np.pi) % TURN - np.pi, way[:, 1:]], axis=1)) for way in ways[:2]
    ]
    found = import_demonstrations(table(tmp_path / "a.csv", *wrapped, (TIMES, ways[2])), spinner)
    begins = [episode.state[0, 0] for episode in found.episodes]
    assert np.ptp(begins) < 0.31


def test_a_joint_with_stops_is_never_moved_by_turns(tmp_path: Path, spinner: Robot) -> None:
    states = WAY + np.array([0, TURN, 0])
    with pytest.raises(UserError, match=r"joint elbow is at 5.2832 rad, above its upper limit"):
        import_demonstrations(table(tmp_path / "a.csv", (TIMES, states)), spinner)


def test_a_jaco_that_wraps_is_imported(tmp_path: Path) -> None:
    """Its joints 1, 4, 5 and 6 are continuous; its driver wraps them."""
    folder = Path(pytest.importorskip("dm_control").__file__).parent / "third_party/kinova"
    arm = load_robot(str(folder / "jaco_arm.xml"), "wristsite")
    way = np.linspace(0, 2, T)[:, None] * [1, 0.1, 0.1, 1, -1, 1] + [2, 3, 3, 3, -2, 40 * TURN]
    states = np.where([1, 0, 0, 1, 1, 0], (way + np.pi) % TURN - np.pi, way)
    found = import_demonstrations(table(tmp_path / "a.csv", (TIMES, states), names=arm.joint_names), arm)
    one_way(found, way)
    assert not arm.limits.violation(found.episodes[0].state).any()


@pytest.mark.parametrize(("base", "elbow"), [(99.0, 0.0), (99.0, 2.14), (0.0, 2.14), (30.0, -2.5)])
def test_radians_are_never_advised_to_be_degrees(
    tmp_path: Path, spinner: Robot, base: float, elbow: float
) -> None:
    """A count of 99 rad at a joint without stops, and 3.14 rad against a limit of 2 rad."""
    path = table(tmp_path / "a.csv", (TIMES, 0.3 * WAY + [base, elbow, 0]))
    if elbow == 0.0:
        one_way(import_demonstrations(path, spinner), 0.3 * WAY + [base, 0, 0])
        return
    with pytest.raises(UserError, match="joint elbow is at") as refusal:
        import_demonstrations(path, spinner)
    assert "deg" not in str(refusal.value)


@pytest.mark.parametrize("seen", ["at a joint with stops", "by its speed"])
def test_degrees_are_recognised_by_evidence(tmp_path: Path, spinner: Robot, seen: str) -> None:
    degrees = np.rad2deg(WAY * [1, 0.05 if seen == "by its speed" else 1, 1])
    said = "goes up to 57.3, more than two turns" if "stops" in seen else r"base moves at [\d.]+ a second"
    path = table(tmp_path / "a.csv", (TIMES, degrees))
    with pytest.raises(UserError, match=f"{said}.*--units deg"):
        import_demonstrations(path, spinner)
    one_way(import_demonstrations(path, spinner, ImportOptions(units=("deg",))), np.deg2rad(degrees))


@pytest.mark.parametrize(
    ("scale", "told", "said"),
    [(1e9, None, "ns"), (1e6, None, "us"), (1e3, None, "ms"), (1e3, "ms", None), (1, "s", None)],
)
def test_the_unit_of_timestamps_is_known_from_their_spacing(
    tmp_path: Path, spinner: Robot, scale: float, told: str | None, said: str | None
) -> None:
    stamps = 1_636_000_000 * scale + (TIMES * scale if scale == 1 else np.round(TIMES * scale))
    found = import_demonstrations(
        table(tmp_path / "a.csv", (stamps, WAY)), spinner, ImportOptions(time_unit=told)
    )
    assert found.rate_hz == 20.0
    np.testing.assert_allclose(found.episodes[0].timestamp, TIMES, atol=1e-6)
    assert found.import_record.get("timestamps", "").startswith(f"taken for {said}" if said else "")


def gap(path: Path) -> Path:
    late = TIMES + 126.0 * (np.arange(T) >= 20)
    return table(path, (late, WAY), (TIMES, WAY))


def test_a_gap_is_named_and_the_episode_split_or_kept(tmp_path: Path, spinner: Robot) -> None:
    path = gap(tmp_path / "a.csv")
    with pytest.raises(
        UserError, match=r"episode a has 1 gap, the longest of 126 s after 0.95 s.*--gaps split"
    ):
        import_demonstrations(path, spinner)
    split = import_demonstrations(path, spinner, ImportOptions(gaps="split"))
    assert [len(one.state) for one in split.episodes] == [20, 40, 60]
    assert split.rate_hz == 20.0
    np.testing.assert_allclose(np.concatenate([one.state for one in split.episodes[:2]]), WAY)
    assert all(one.timestamp[0] == 0 and np.diff(one.timestamp).max() < 0.051 for one in split.episodes)
    assert "split into 3 episodes" in split.import_record["gaps"]
    kept = import_demonstrations(path, spinner, ImportOptions(gaps="keep"))
    assert len(kept.episodes) == 2
    assert "126 s" in kept.warnings[0]
    with pytest.raises(UserError, match="episode a has a gap: pass --gaps split"):
        import_demonstrations(path, spinner, ImportOptions(gaps="keep", resample_hz=10))


def test_parts_of_one_sample_are_no_episodes(tmp_path: Path, spinner: Robot) -> None:
    times = TIMES + 9.0 * (np.arange(T) >= 30) + 9.0 * (np.arange(T) >= 31)
    split = import_demonstrations(
        table(tmp_path / "a.csv", (times, WAY)), spinner, ImportOptions(gaps="split")
    )
    assert [len(one.state) for one in split.episodes] == [30, 29]


def test_episodes_of_different_rates_are_named_and_resampled(tmp_path: Path, spinner: Robot) -> None:
    fast = np.arange(3 * T) / 60
    states = np.stack([np.interp(fast, TIMES, joint) for joint in WAY.T], axis=1)
    path = table(tmp_path / "a.csv", (TIMES, WAY), (fast, states))
    with pytest.raises(
        UserError, match=r"episode a is sampled at 20 Hz and episode b at 60 Hz.*--resample-hz 20"
    ):
        import_demonstrations(path, spinner)
    found = import_demonstrations(path, spinner, ImportOptions(resample_hz=20))
    assert "linear interpolation" in found.import_record["resampled"]
    for episode in found.episodes:
        np.testing.assert_allclose(episode.state, WAY, atol=1e-6)
        np.testing.assert_allclose(episode.timestamp, TIMES)
    with pytest.raises(UserError, match="it must be a finite number above zero"):
        import_demonstrations(path, spinner, ImportOptions(resample_hz=0.0))


def test_a_way_across_half_a_turn_is_resampled_along_the_way(tmp_path: Path, spinner: Robot) -> None:
    states = np.concatenate([(WAY[:, :1] + np.pi) % TURN - np.pi, WAY[:, 1:]], axis=1)
    found = import_demonstrations(
        table(tmp_path / "a.csv", (TIMES, states)), spinner, ImportOptions(resample_hz=50)
    )
    speed = np.abs(np.diff(found.episodes[0].state, axis=0)) * 50
    assert speed.max() < 1.5


@pytest.mark.parametrize(
    ("separator", "decimal"), [(";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", ".")]
)
@pytest.mark.parametrize("packed", [False, True])
def test_tables_of_any_dialect_are_read(
    tmp_path: Path, spinner: Robot, separator: str, decimal: str, packed: bool
) -> None:
    path = table(tmp_path / "a.csv", (TIMES, WAY), separator=separator, decimal=decimal)
    if packed:
        (tmp_path / "b.csv.gz").write_bytes(gzip.compress(path.read_bytes()))
        path = tmp_path / "b.csv.gz"
    found = import_demonstrations(path, spinner)
    np.testing.assert_allclose(found.episodes[0].state, WAY, atol=1e-8)
    assert found.rate_hz == 20.0


def rostopic(path: Path, names: Sequence[str], change: int = T) -> Path:
    count = range(len(names))
    header = [
        "%time",
        "field.header.seq",
        *(f"field.name{i}" for i in count),
        *(f"field.position{i}" for i in count),
    ]
    lines = [header]
    for row in range(T):
        called = names if row < change else names[::-1]
        values = {**dict(zip(JOINTS, WAY[row], strict=True)), "gripper": 0.04}
        lines.append(
            [str(10**18 + row * 50_000_000), str(row), *called, *(f"{values[name]:.9f}" for name in called)]
        )
    path.write_text("\n".join(map(",".join, lines)))
    return path


def test_what_rostopic_prints_is_read(tmp_path: Path, spinner: Robot) -> None:
    names = ["gripper", "wrist", "base", "elbow"]
    found = import_demonstrations(rostopic(tmp_path / "a.csv", names), spinner)
    np.testing.assert_allclose(found.episodes[0].state, WAY, atol=1e-8)
    assert (found.episodes[0].extras["observation.gripper"] == 0.04).all()
    with pytest.raises(UserError, match="line 32 names other joints than line 2"):
        import_demonstrations(rostopic(tmp_path / "b.csv", names, change=30), spinner)
    (tmp_path / "c.csv").write_text("%time,field.linear.x\n1,2\n2,3\n")
    with pytest.raises(UserError, match=r"not from a topic of sensor_msgs/JointState: .*rostopic echo -b"):
        import_demonstrations(tmp_path / "c.csv", spinner)


def test_episodes_are_left_out_by_name(tmp_path: Path, spinner: Robot) -> None:
    path = table(tmp_path / "a.csv", (TIMES, WAY), (TIMES[:1], WAY[:1]), (TIMES, -WAY))
    with pytest.raises(UserError, match=r"episode b has a single sample.*--leave-out"):
        import_demonstrations(path, spinner)
    found = import_demonstrations(path, spinner, ImportOptions(leave_out=("b", "a")))
    np.testing.assert_allclose(found.episodes[0].state, -WAY, atol=1e-8)
    assert found.import_record["episodes left out"] == "b, a"
    with pytest.raises(UserError, match=r"has no episode 'x'; it has a, b, c"):
        import_demonstrations(path, spinner, ImportOptions(leave_out=("x",)))


def test_a_folder_of_files_has_an_episode_for_each(tmp_path: Path, spinner: Robot) -> None:
    for number in range(3):
        table(tmp_path / f"take{number}.csv", (TIMES + number, WAY * (1 - number / 4)), labels=None)
    (tmp_path / "notes.txt").write_text("not a recording")
    found = import_demonstrations(tmp_path, spinner)
    for number, episode in enumerate(found.episodes):
        np.testing.assert_allclose(episode.state, WAY * (1 - number / 4), atol=1e-8)
    assert found.episodes[1].task == "take1"
    assert "3 files, CSV" in found.import_record["source"]
    assert (
        len(import_demonstrations(tmp_path, spinner, ImportOptions(leave_out=("take1.csv",))).episodes) == 2
    )
    np.savez(tmp_path / "z.npz", q=WAY, episode_ends=[T], rate_hz=20.0)
    with pytest.raises(UserError, match=r"holds files of different kinds, such as take0\.csv"):
        import_demonstrations(tmp_path, spinner)


def aloha(folder: Path) -> Path:
    folder.mkdir()
    for number in range(2):
        with h5py.File(folder / f"episode_{number}.hdf5", "w") as file:
            file["observations/qpos"] = np.tile(WAY[:, [1]], 14) * np.linspace(0.1, 1, 14) + number / 10
            file["action"] = np.tile(WAY[:, [1]], 14)
    return folder


def test_aloha_is_read(tmp_path: Path) -> None:
    source = aloha(tmp_path / "pick")
    with pytest.raises(UserError, match="does not say its rate: pass --rate-hz 50"):
        import_demonstrations(source)
    found = import_demonstrations(source, options=ImportOptions(rate_hz=50))
    assert found.joint_names[0] == "left_waist"
    assert found.joint_names[13] == "right_gripper"
    assert [one.task for one in found.episodes] == ["pick", "pick"]
    assert all(one.action is None for one in found.episodes)  # where to go, not how fast
    np.testing.assert_allclose(found.episodes[1].state[:, 13], WAY[:, 1] + 0.1)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3", "a"])
def test_bags_are_read(tmp_path: Path, spinner: Robot, name: str) -> None:
    order = ["wrist", "base", "elbow"]
    rows = WAY[:, [2, 0, 1]].tolist()
    bag = joint_state_bag(tmp_path / name, order, rows, alone={"gripper": 0.03}, stamped=name != "a.mcap")
    found = import_demonstrations(bag, spinner)
    np.testing.assert_allclose(found.episodes[0].state, WAY)
    assert found.rate_hz == 20.0
    assert (found.episodes[0].extras["observation.gripper"] == 0.03).all()
    assert import_demonstrations(tmp_path, spinner).episodes[0].task == found.episodes[0].task


@pytest.mark.parametrize("name", ["a.bag", "a.mcap"])
def test_the_topic_of_a_bag_is_chosen(tmp_path: Path, spinner: Robot, name: str) -> None:
    bag = joint_state_bag(tmp_path / name, list(JOINTS), WAY.tolist(), topics=("/left", "/right"))
    with pytest.raises(UserError, match="/left, /right; choose one with --topic"):
        import_demonstrations(bag, spinner)
    with pytest.raises(UserError, match="/left, /right; choose one with --topic"):
        import_demonstrations(bag, spinner, ImportOptions(topic="/middle"))
    np.testing.assert_allclose(
        import_demonstrations(bag, spinner, ImportOptions(topic="/right")).episodes[0].state, WAY
    )
    with pytest.raises(UserError, match=r"has these topics of sensor_msgs/msg/JointState: none\.$"):
        import_demonstrations(joint_state_bag(tmp_path / f"b{name}", [], [], topics=()), spinner)


def test_without_rosbags_a_bag_says_how_to_get_it(
    tmp_path: Path, spinner: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = joint_state_bag(tmp_path / "a.bag", list(JOINTS), WAY.tolist())
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(UserError, match=r"pip install 'latentarm\[bags\]'"):
        import_demonstrations(bag, spinner)


def test_without_h5py_an_hdf5_file_says_how_to_get_it(
    tmp_path: Path, spinner: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    h5py.File(tmp_path / "demo.hdf5", "w").close()
    for module in ("aloha", "robomimic", "hdf5_tables"):
        monkeypatch.delitem(sys.modules, f"latentarm.demonstrations.importers.{module}", raising=False)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(UserError, match=r"pip install 'latentarm\[hdf5\]'"):
        import_demonstrations(tmp_path / "demo.hdf5", spinner)


turns = st.lists(st.integers(-50, 50), min_size=2, max_size=2)


@given(begin=turns, way=st.lists(st.floats(-0.5, 0.5), min_size=3, max_size=40), wraps=st.booleans())
def test_unwrapping_undoes_any_wrapping(
    tmp_path_factory: pytest.TempPathFactory, spinner: Robot, begin: list[int], way: list[float], wraps: bool
) -> None:
    from latentarm.core.types import Episode
    from latentarm.demonstrations.importers.turns import unwrapped

    path = np.cumsum(way)[:, None] * [1, 0, -1]
    episodes = [
        Episode(
            (path + np.pi) % TURN - np.pi if wraps else path + np.array([turn * TURN, 0, turn * TURN]),
            np.arange(len(way)) / 20,
        )
        for turn in begin
    ]
    found, said = unwrapped(episodes, spinner)
    for episode in found:
        off = (episode.state - path) / TURN
        np.testing.assert_allclose(off - np.round(off[0]), 0, atol=1e-9)
    if said:
        starts = [episode.state[0, 0] for episode in found]
        assert np.ptp(starts) <= np.pi + 1e-9


PANDA_CASES = {
    "csv_ns/a.csv": {},
    "csv_excel_de/a.csv": {},
    "csv_gz/a.csv.gz": {},
    "csv_gz": {},
    "csv_rostopic/a.csv": {},
    "csv_rates/a.csv": {"resample_hz": 10.0},
    "csv_one_row_episode/a.csv": {"leave_out": ("1",)},
}
REFUSED = {
    "csv_rates/a.csv": "sampled at 10 Hz and episode 1 at 50 Hz",
    "csv_one_row_episode/a.csv": "episode 1 has a single sample",
    "csv_gz/a.zip": r"is a \.zip of other files",
    "h5_raw_robosuite/demo.hdf5": "dataset_states_to_obs",
    "h5_aloha": "pass --rate-hz 50",
}


@pytest.fixture(scope="module")
def cases() -> Path:
    if not SHARED.is_dir():
        pytest.skip("the inputs that once failed are not beside the project")
    return SHARED


@pytest.mark.parametrize("name", PANDA_CASES)
def test_an_input_that_failed_is_imported(cases: Path, tmp_path: Path, name: str) -> None:
    found = import_to(cases / name, tmp_path / "data", panda(), ImportOptions(**PANDA_CASES[name]))
    assert found.rate_hz in (10.0, 20.0)
    assert len(np.concatenate([one.state for one in found.episodes])) >= 60


@pytest.mark.parametrize("name", REFUSED)
def test_an_input_that_failed_is_refused_with_what_to_do(cases: Path, name: str) -> None:
    with pytest.raises(UserError, match=REFUSED[name]):
        import_demonstrations(cases / name, panda())


def test_the_inputs_of_other_arms_are_imported(cases: Path) -> None:
    arm = load_robot(str(cases / "csv_wrap/wrap.xml"))
    found = import_demonstrations(cases / "csv_wrap/a.csv", arm)
    assert "j0 wraps 4 times" in found.import_record["turns"]
    assert max(np.abs(np.diff(one.state, axis=0)).max() for one in found.episodes) < 0.1
    assert len(import_demonstrations(cases / "h5_aloha", options=ImportOptions(rate_hz=50)).episodes) == 3
