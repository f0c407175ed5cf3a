"""Every kind of bad file is refused with its own sentence, and leaves nothing behind."""

import gzip
import json
import pickle
import shutil
import struct
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags import joint_state_bag
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.importers import csv_lines
from latentarm.demonstrations.importers.importing import import_demonstrations, import_to
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot

HOME = np.array([0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8])
N = 12


def good_arrays() -> dict[str, np.ndarray]:
    q = HOME + 0.01 * np.arange(N)[:, None]
    return {"q": q, "episode_ends": np.array([5, N]), "rate_hz": np.array(10.0)}


def npz(**changes: object) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        arrays = good_arrays() | changes
        path = folder / "source.npz"
        np.savez(path, **{key: value for key, value in arrays.items() if value is not None})
        return path

    return make


def q_with(sample: int, joint: int, value: float) -> np.ndarray:
    q = good_arrays()["q"]
    q[sample, joint] = value
    return q


def raw(name: str, content: bytes) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / name).write_bytes(content)
        return folder / name

    return make


def truncated_npz(folder: Path) -> Path:
    path = npz()(folder)
    path.write_bytes(path.read_bytes()[:-200])
    return path


def damaged_npz(folder: Path) -> Path:
    path = npz()(folder)
    content = bytearray(path.read_bytes())
    content[400] ^= 0xFF
    path.write_bytes(bytes(content))
    return path


def lying_npz(shape: str) -> Callable[[Path], Path]:
    """An archive whose array declares far more than it has."""

    def make(folder: Path) -> Path:
        header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(117) + b"\n"
        npy = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + b"\0" * 80
        with zipfile.ZipFile(folder / "source.npz", "w") as archive:
            archive.writestr("q.npy", npy)
        return folder / "source.npz"

    return make


def huge_npz(folder: Path) -> Path:
    """More numbers than an import may hold, packed small and honestly declared."""
    path = folder / "source.npz"
    header = {"descr": "|u1", "fortran_order": False, "shape": ((1 << 24) + 1, 8)}
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("q.npy", "w", force_zip64=True) as stream,
    ):
        np.lib.format.write_array_header_1_0(stream, header)
        for _ in range(1 << 7):
            stream.write(bytes(1 << 20))
        stream.write(bytes(8))
    return path


def csv(*lines: str) -> Callable[[Path], Path]:
    return raw("source.csv", "\n".join(lines).encode())


HEADER = "episode,timestamp," + ",".join(f"q{joint}" for joint in range(7))


def line(episode: int, time: float, *, value: str = "0.1") -> str:
    return f"{episode},{time},0,-0.5,0,-2,0,1.6,{value}"


def hdf5(fill: Callable[[h5py.File], None]) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        with h5py.File(folder / "source.hdf5", "w") as file:
            fill(file)
        return folder / "source.hdf5"

    return make


def add_demo(file: h5py.File, states: np.ndarray | None, frequency: float | None = 20) -> None:
    data = file.require_group("data")
    if frequency is not None:
        data.attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": frequency}})
    observations = data.create_group("demo_0/obs")
    if states is not None:
        observations["robot0_joint_pos"] = states


def linked(file: h5py.File) -> None:
    add_demo(file, None)
    file["data/demo_0/obs"]["robot0_joint_pos"] = h5py.ExternalLink("/etc/passwd", "/anything")


def add_aloha(file: h5py.File, states: np.ndarray) -> None:
    file["observations/qpos"] = states


def simulated(file: h5py.File) -> None:
    file["data/demo_1/states"] = np.zeros((9, 32))


def zipped(folder: Path) -> Path:
    with zipfile.ZipFile(folder / "source.zip", "w") as archive:
        archive.writestr("a.csv", "timestamp,q0")
    return folder / "source.zip"


def bomb(folder: Path) -> Path:
    """Lines that fill memory once unpacked, in 300 kB."""
    lines = gzip.compress((b"0," + b" " * 1021 + b"1\n") * 1024, compresslevel=1)
    (folder / "source.csv.gz").write_bytes(gzip.compress(b"timestamp,q0\n") + lines * 260)
    return folder / "source.csv.gz"


def cut_bag(name: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = joint_state_bag(folder / name, ["a", "b"], [[0.1, 0.2]] * 30)
        path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
        return path

    return make


def sparse(file: h5py.File) -> None:
    add_demo(file, None)
    file["data/demo_0/obs"].create_dataset("robot0_joint_pos", (1 << 40, 7), "f8", chunks=(64, 7))


def truncated_hdf5(folder: Path) -> Path:
    path = hdf5(lambda file: add_demo(file, np.tile(HOME, (500, 1))))(folder)
    path.write_bytes(path.read_bytes()[:-3000])
    return path


def dataset(damage: Callable[[Path], None]) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        q = good_arrays()["q"]
        episodes = (Episode(q[:5], np.arange(5) / 10), Episode(q[5:], np.arange(7) / 10))
        names = tuple(f"joint{joint + 1}" for joint in range(7))
        write_dataset(Demonstrations(episodes, 10.0, names), folder / "source")
        damage(folder / "source")
        return folder / "source"

    return make


def info(**changes: object) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        document = json.loads((path / "meta/info.json").read_text()) | changes
        (path / "meta/info.json").write_text(json.dumps(document))

    return damage


def cut(name: str) -> Callable[[Path], None]:
    return lambda path: (path / name).write_bytes((path / name).read_bytes()[:-20])


DATA = "data/chunk-000/file-000.parquet"


def ragged_states(path: Path) -> None:
    table = pq.read_table(path / DATA)
    lists = table.column("observation.state").to_pylist()
    lists[3] = lists[3][:6]
    place = table.schema.get_field_index("observation.state")
    pq.write_table(table.set_column(place, "observation.state", pa.array(lists)), path / DATA)


def lost_samples(path: Path) -> None:
    pq.write_table(pq.read_table(path / DATA).slice(0, 9), path / DATA)


def without_column(path: Path) -> None:
    pq.write_table(pq.read_table(path / DATA).drop_columns(["timestamp"]), path / DATA)


TIMES = np.concatenate([np.arange(5), np.arange(7)]) / 10


def times_with(sample: int, value: float) -> np.ndarray:
    times = TIMES.copy()
    times[sample] = value
    return times


MALFORMED: dict[str, tuple[Callable[[Path], Path], str]] = {
    "NaN": (npz(q=q_with(7, 2, np.nan)), r"episode 1, sample 2: observation.state\[2\] is not a number"),
    "infinity": (npz(q=q_with(3, 0, np.inf)), r"episode 0, sample 3: observation.state\[0\] is infinite"),
    "absurd": (npz(q=q_with(3, 0, 1e300)), r"episode 0, sample 3: .* is absurdly large"),
    "NaN in dq": (npz(dq=q_with(6, 1, np.nan)), r"episode 1, sample 1: observation.velocity\[1\] is not a"),
    "wrong DoF": (npz(q=np.zeros((N, 6))), "have 6 joints .* but the robot has 7"),
    "flat states": (npz(q=np.zeros(N)), r"'q' has the shape \(12,\)"),
    "above limits": (npz(q=q_with(8, 3, 0.5)), r"episode 1, sample 3: joint \S+ is at 0.5000 rad, above"),
    "below limits": (npz(q=q_with(1, 5, -0.5)), r"episode 0, sample 1: joint \S+ is at -0.5000 rad, below"),
    "rate zero": (npz(rate_hz=0.0), "rate is 0 Hz"),
    "rate negative": (npz(rate_hz=-10.0), "rate is -10 Hz"),
    "rate NaN": (npz(rate_hz=np.nan), "rate is nan Hz"),
    "no rate": (npz(rate_hz=None), "has no single 'rate_hz'; .* --rate-hz"),
    "no states": (npz(q=None), "has no array 'q'"),
    "no episode ends": (npz(episode_ends=None), "has no array 'episode_ends'"),
    "no episodes": (npz(episode_ends=np.zeros(0, int)), "there are no episodes in it"),
    "empty episode": (npz(episode_ends=[5, 5, N]), "episode 1 is empty"),
    "backward episode": (npz(episode_ends=[8, 5, N]), "episode 1 ends at sample 5, before it begins"),
    "single sample": (npz(episode_ends=[1, N]), "episode 0 has a single sample"),
    "samples missing": (npz(episode_ends=[5, N + 3]), "ends at 15, but there are 12 samples"),
    "fractional ends": (npz(episode_ends=[5.5, 12.0]), "must be a row of whole numbers"),
    "ragged dq": (npz(dq=np.zeros((N - 1, 7))), r"the array 'dq' has the shape \(11, 7\)"),
    "repeating time": (npz(timestamp=times_with(2, 0.1)), "episode 0, sample 2: .* 0.1 s repeats"),
    "falling time": (npz(timestamp=times_with(9, 0.05)), "episode 1, sample 4: .* falls from 0.3 s to 0.05"),
    "gripper": (npz(gripper_toggles=[3, 40]), "'gripper_toggles' must be indices"),
    "complex states": (npz(q=np.zeros((N, 7), complex)), "'q' holds complex128"),
    "pickle inside": (npz(q=np.array([[1], [2, 3]], dtype=object)), "holds pickled objects"),
    "truncated npz": (truncated_npz, "not a whole .npz file"),
    "damaged npz": (damaged_npz, "not a whole .npz file"),
    "lying npz": (lying_npz("(1000000000000, 7)"), "declares the shape .* does not hold as much"),
    "negative shape": (lying_npz("(-10, -1)"), "declares the shape .* does not hold as much"),
    "huge npz": (huge_npz, "over the limit"),
    "zip": (zipped, "is a .zip of other files: unpack it"),
    "packed too well": (bomb, "holds more than 268,435,456 characters"),
    "cut gzip": (
        raw("source.csv.gz", gzip.compress(b"timestamp,q0\n0,1\n" * 99)[:-30]),
        "not a readable CSV",
    ),
    "ALOHA without a rate": (hdf5(lambda file: add_aloha(file, np.zeros((9, 14)))), "pass --rate-hz 50"),
    "only the simulator's states": (hdf5(simulated), "dataset_states_to_obs"),
    "cut bag": (cut_bag("a.bag"), "is not a whole bag of ROS"),
    "cut MCAP": (cut_bag("a.mcap"), "is not a whole bag of ROS"),
    "not a bag": (raw("source.db3", b"SQLite format 3\0" + bytes(99)), "is not a whole bag of ROS"),
    "a gap": (
        npz(timestamp=TIMES + (np.arange(N) == 4) * 126),
        "episode 0 has 1 gap.* of 126.1 s after 0.3 s",
    ),
    "two rates": (
        npz(timestamp=TIMES * np.where(np.arange(N) < 5, 0.2, 1)),
        "1 is sampled at 10 Hz and episode 0 at 50",
    ),
    "renamed text": (raw("source.npz", b"not an archive"), "does not hold what its name says"),
    "pickle": (raw("source.pkl", pickle.dumps([1, 2])), "a pickle, which is never opened"),
    "bare array": (raw("source.npy", b"\x93NUMPY\x01\x00"), "a single array"),
    "bare parquet": (raw("source.parquet", b"PAR1...."), "a single Parquet file"),
    "empty file": (raw("source.csv", b""), "an empty file"),
    "binary": (raw("source.bin", bytes(range(160, 256))), "not a readable CSV"),
    "missing file": (lambda folder: folder / "source.npz", "No such file"),
    "no columns": (csv("a,b,c", "1,2,3"), "has no column 'timestamp'"),
    "no joints": (csv("episode,timestamp", "0,0.1"), "has no column of joint positions"),
    "double column": (csv(f"{HEADER},q0"), "column 'q0' occurs twice"),
    "no lines": (csv(HEADER), "has no line after its header"),
    "ragged line": (csv(HEADER, line(0, 0), "0,0.1,0.5"), "line 3 is ragged: 3 fields under 9 columns"),
    "words": (csv(HEADER, line(0, 0), line(0, 0.1, value="up")), "line 3, column 'q6': 'up' is not a number"),
    "returning": (csv(HEADER, line(0, 0), line(1, 0), line(0, 1)), "line 4 goes back to episode '0'"),
    "falling CSV": (csv(HEADER, line(0, 0.2), line(0, 0.1)), "sample 1: the timestamp falls"),
    "no demos": (hdf5(lambda file: file.create_group("data").create_group("mask")), "has no demonstrations"),
    "foreign HDF5": (hdf5(lambda file: file.create_group("weights")), "has no group data"),
    "no joint positions": (hdf5(lambda file: add_demo(file, None)), "has no joint positions"),
    "no frequency": (hdf5(lambda file: add_demo(file, np.zeros((9, 7)), None)), "its control frequency"),
    "frequency zero": (hdf5(lambda file: add_demo(file, np.zeros((9, 7)), 0)), "control frequency is 0 Hz"),
    "flat HDF5": (hdf5(lambda file: add_demo(file, np.zeros(9))), "is not a plain table of numbers"),
    "linked HDF5": (hdf5(linked), "has no joint positions"),
    "sparse HDF5": (hdf5(sparse), "declares 7,696,581,394,432 numbers, over the limit"),
    "truncated HDF5": (truncated_hdf5, "not a whole HDF5 file"),
    "empty folder": (lambda folder: folder, r"holds no recordings: .* ending in \.csv"),
    "old layout": (dataset(info(codebase_version="v1.6")), "layout v1.6"),
    "older without a list": (dataset(info(codebase_version="v2.1")), "episodes.jsonl cannot be read"),
    "nameless columns": (npz(joint_names=["a", "b"]), "'joint_names' has 2 names, but 'q' has 7"),
    "another robot": (npz(robot="UR5e"), "recorded on 'UR5e', and the robot is panda.*--recorded-on UR5e"),
    "degrees": (npz(q=np.rad2deg(good_arrays()["q"])), "pass --units deg"),
    "too slow a rate": (npz(rate_hz=0.2), "is 0.2 Hz; recordings of arms have 1 to 1000 Hz"),
    "times in ms": (
        npz(timestamp=100 * np.arange(12.0)),
        "timestamps advance at 0.01 Hz, but the rate is 10",
    ),
    "a jump": (npz(q=q_with(3, 0, 2.8), rate_hz=500.0), "sample 3: joint joint1 moves at 1390 rad/s"),
    "foreign names": (npz(joint_names=list("abcdefg")), "cannot be matched .* --joints a b c d e f g"),
    "no version": (dataset(info(codebase_version=None)), "the entry 'codebase_version' is missing"),
    "no state feature": (dataset(info(features={})), "has no observation.state"),
    "fps zero": (dataset(info(fps=0)), "rate is 0 Hz"),
    "fps huge": (dataset(info(fps=10**400)), "a whole number of more than 20 digits"),
    "episodes absurd": (dataset(info(total_episodes=1 << 40)), "over the limit"),
    "fps text": (dataset(info(fps="ten")), "'fps' is missing or not a sensible number"),
    "zero episodes": (dataset(info(total_episodes=0)), "there are no episodes in it"),
    "too many promised": (dataset(info(total_episodes=3)), "does not list the 3 episodes in order"),
    "absurdly many": (dataset(info(total_frames=1 << 40)), "over the limit"),
    "wrong total": (dataset(info(total_frames=11)), "hold 12 samples and not 11"),
    "negative total": (dataset(info(total_episodes=-1)), "cannot be below zero"),
    "broken JSON": (dataset(cut("meta/info.json")), "is not a JSON document"),
    "cut samples": (dataset(cut(DATA)), r"file-000.parquet is not a whole Parquet file"),
    "cut episodes": (
        dataset(cut("meta/episodes/chunk-000/file-000.parquet")),
        "episodes.*not a whole Parquet",
    ),
    "no samples": (dataset(lambda path: (path / DATA).unlink()), "file-000.parquet is missing"),
    "ragged states": (dataset(ragged_states), "column observation.state is ragged"),
    "lost samples": (dataset(lost_samples), "episode 1 should have 7 samples in order and has 4"),
    "lost column": (dataset(without_column), "has no column timestamp"),
}


@pytest.fixture(scope="module")
def arm() -> Robot:
    return panda()


@pytest.mark.parametrize("kind", MALFORMED)
def test_a_malformed_source_is_refused_and_leaves_nothing(tmp_path: Path, arm: Robot, kind: str) -> None:
    make, sentence = MALFORMED[kind]
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    source = make(tmp_path / "in")
    with pytest.raises(UserError, match=sentence) as refusal:
        import_to(source, tmp_path / "out" / "data", arm)
    said = str(refusal.value)
    assert str(tmp_path / "in") in said
    assert said.endswith(".")
    assert "\n" not in said
    assert not list((tmp_path / "out").iterdir())


def test_the_sentences_are_distinct(tmp_path: Path, arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_lines, "MAX_TEXT_BYTES", 1 << 20)  # read up to the real one above
    said: dict[str, str] = {}
    for kind, (make, _) in MALFORMED.items():
        if kind in {
            "damaged npz",
            "linked HDF5",
            "negative shape",
            "huge npz",
            "fps huge",
            "episodes absurd",
        }:
            continue  # the same fault for the person as one other
        folder = tmp_path / "in"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        with pytest.raises(UserError) as refusal:
            import_to(make(folder), tmp_path / "out", arm)
        said[kind] = str(refusal.value).replace(str(folder), "")
    assert len(set(said.values())) == len(said)


@pytest.mark.parametrize("column", ["observation.state.list.element", "timestamp"])
def test_a_flipped_bit_among_the_samples_is_noticed(tmp_path: Path, column: str) -> None:
    def flip(path: Path) -> None:
        group = pq.read_metadata(path / DATA).row_group(0)
        chunks = {
            group.column(index).path_in_schema: group.column(index) for index in range(group.num_columns)
        }
        start = chunks[column].dictionary_page_offset or chunks[column].data_page_offset
        content = bytearray((path / DATA).read_bytes())
        content[start + chunks[column].total_compressed_size - 1] ^= 0x10
        (path / DATA).write_bytes(bytes(content))

    with pytest.raises(UserError, match="truncated or damaged"):
        import_to(dataset(flip)(tmp_path), tmp_path / "out")


BYTES = st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.binary(max_size=3)), min_size=1, max_size=4)


def edited(content: bytes, edits: list[tuple[float, bytes]]) -> bytes:
    """The content with one byte replaced by others, or by none, at each place."""
    for place, new in edits:
        index = int(place * len(content))
        content = content[:index] + new + content[index + 1 :]
    return content


@given(kind=st.sampled_from(["header", "npz", "csv", "info"]), edits=BYTES)
@settings(max_examples=150)
def test_no_edit_of_a_source_is_more_than_refused(kind: str, edits: list[tuple[float, bytes]]) -> None:
    """Whatever bytes a source holds, it imports or is refused in one sentence: nothing else."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if kind == "header":
            source = npz()(folder)
            with zipfile.ZipFile(source) as archive:
                members = {member: archive.read(member) for member in archive.namelist()}
            members["q.npy"] = edited(members["q.npy"][:128], edits) + members["q.npy"][128:]
            with zipfile.ZipFile(source, "w") as archive:
                for member, content in members.items():
                    archive.writestr(member, content)
        else:
            source = {
                "npz": npz(),
                "csv": csv(HEADER, line(0, 0), line(0, 0.1), line(1, 0), line(1, 0.1)),
                "info": dataset(lambda path: None),
            }[kind](folder)
            target = source / "meta/info.json" if kind == "info" else source
            target.write_bytes(edited(target.read_bytes(), edits))
        try:
            import_to(source, folder / "out")
        except UserError:
            assert not (folder / "out").exists()


def test_the_unspoilt_sources_are_fine(tmp_path: Path, arm: Robot) -> None:
    (tmp_path / "in").mkdir()
    import_to(npz()(tmp_path / "in"), tmp_path / "npz", arm)
    import_to(dataset(lambda path: None)(tmp_path / "in"), tmp_path / "dataset", arm)
    import_to(csv(HEADER, line(0, 0), line(0, 0.1))(tmp_path / "in"), tmp_path / "csv", arm)
    moving = HOME + 0.01 * np.arange(9)[:, None]
    import_to(hdf5(lambda file: add_demo(file, moving))(tmp_path / "in"), tmp_path / "hdf5", arm)


def test_a_taken_destination_is_refused_before_the_source_is_read(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/diary.txt").write_text("mine")
    with pytest.raises(UserError, match="already exists and is not empty"):
        import_to(tmp_path / "nowhere.npz", tmp_path / "out")


def test_what_may_not_be_read_is_not_called_damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests may run as a user who may read everything, so the refusal is played."""

    def refuse(path: Path) -> bool:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "is_dir", refuse)
    with pytest.raises(UserError, match=r"source\.npz cannot be read: Permission denied"):
        import_demonstrations(tmp_path / "source.npz")
    monkeypatch.setattr(Path, "lstat", refuse)
    monkeypatch.setattr(Path, "stat", refuse)
    with pytest.raises(UserError, match=r"info\.json cannot be read: Permission denied"):
        read_dataset(tmp_path)
