"""Datasets to and from the real LeRobot, in an environment of its own.

``LATENTARM_LEROBOT_PYTHON`` may name an interpreter that has it; otherwise one is built once, in
``.venv-lerobot`` at the project's root (several GB, some minutes, over the network).
"""

import json
import os
import subprocess
import venv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import append_episode, read_dataset, write_dataset
from latentarm.demonstrations.importers.importing import import_demonstrations, import_to
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.robots.robot import Robot

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
VERSION = "lerobot==0.4.4"

READ = """
import json, sys
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset

dataset = LeRobotDataset("local/data", root=sys.argv[1])
index = int(sys.argv[2])
item = dataset[index]
window = {"observation.state": [-0.1, 0.0, 0.1]}
delta = LeRobotDataset("local/data", root=sys.argv[1], delta_timestamps=window)
near = delta[index]
last = LeRobotDataset("local/data", root=sys.argv[1], episodes=[dataset.num_episodes - 1])
print(json.dumps({
    "frames": len(dataset),
    "episodes": dataset.num_episodes,
    "lengths": [int(one["length"]) for one in dataset.meta.episodes][: dataset.num_episodes],
    "fps": dataset.fps,
    "robot": dataset.meta.robot_type,
    "names": dataset.meta.features["observation.state"]["names"],
    "keys": sorted(item),
    "dtypes": {key: str(value.dtype) for key, value in item.items() if torch.is_tensor(value)},
    "shapes": {key: list(value.shape) for key, value in item.items() if torch.is_tensor(value)},
    "item": {key: value.tolist() if torch.is_tensor(value) else value for key, value in item.items()},
    "near": near["observation.state"].tolist(),
    "pad": near["observation.state_is_pad"].tolist(),
    "mean": dataset.meta.stats["observation.state"]["mean"].tolist(),
    "last": [len(last), last[0]["task"]],
}))
"""

WRITE = """
import sys
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

names = ["j1", "j2", "j3"]
vector = {"dtype": "float32", "shape": (3,), "names": names}
features = {
    "observation.state": vector,
    "action": vector,
    "observation.force": {"dtype": "float32", "shape": (1,), "names": None},
    "observation.images.top": {"dtype": "image", "shape": (8, 8, 3), "names": ["h", "w", "c"]},
}
dataset = LeRobotDataset.create(
    "local/data", fps=20, features=features, root=sys.argv[1], robot_type="toy", use_videos=False
)
for episode in range(4):
    for frame in range(5 + episode):
        dataset.add_frame({
            "observation.state": np.full(3, episode + frame / 10, dtype=np.float32),
            "action": np.full(3, frame, dtype=np.float32),
            "observation.force": np.array([0.5], dtype=np.float32),
            "observation.images.top": np.zeros((8, 8, 3), dtype=np.uint8),
            "task": "pick" if episode % 2 else "place",
        })
    dataset.save_episode()
dataset.finalize()
"""

EXTEND = """
import sys
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

dataset = LeRobotDataset("local/data", root=sys.argv[1])
for frame in range(6):
    dataset.add_frame({
        "observation.state": np.full(3, frame / 10, dtype=np.float32),
        "action": np.zeros(3, dtype=np.float32),
        "belief": np.full(2, 0.5, dtype=np.float32),
        "assist.alpha": np.zeros(1, dtype=np.float32),
        "task": "stir",
    })
dataset.save_episode()
dataset.finalize()
"""


def environment() -> Path:
    """An interpreter that has LeRobot; the environment is built on first use."""
    folder = ROOT / ".venv-lerobot"
    python = folder / "bin" / "python"
    ready = folder / "ready"
    if not ready.exists():
        venv.create(folder, with_pip=True, clear=True)
        (folder / ".gitignore").write_text("*\n")
        constraint = folder / "constraint.txt"
        constraint.write_text("torch==2.10.0\n")
        pip = [str(python), "-m", "pip", "install", "--quiet", "--constraint", str(constraint), VERSION]
        subprocess.run(pip, check=True)
        ready.touch()
    return python


@pytest.fixture(scope="module")
def lerobot(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., str]:
    """Run a script with LeRobot and return the last line that it prints."""
    python = os.environ.get("LATENTARM_LEROBOT_PYTHON") or str(environment())
    home = tmp_path_factory.mktemp("home")

    def run(script: str, *arguments: object) -> str:
        offline = {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1", "HF_HOME": str(home)}
        done = subprocess.run(
            [python, "-c", script, *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | offline,
        )
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stdout.strip().rpartition("\n")[2]

    return run


def test_lerobot_reads_what_we_write(
    tmp_path: Path,
    lerobot: Callable[..., str],
    demonstrations: Demonstrations,
    episode_of: Callable[..., Episode],
) -> None:
    write_dataset(demonstrations, tmp_path / "data")
    append_episode(tmp_path / "data", episode_of(3, samples=8, task="stir"))
    seen = json.loads(lerobot(READ, tmp_path / "data", 20))
    episode = read_dataset(tmp_path / "data").episodes[3]

    assert (seen["frames"], seen["episodes"], seen["lengths"]) == (26, 4, [5, 6, 7, 8])
    assert (seen["fps"], seen["robot"], seen["names"]) == (10, "planar", ["shoulder", "elbow", "wrist"])
    item = seen["item"]
    assert (item["episode_index"], item["frame_index"], item["index"], item["task"]) == (3, 2, 20, "stir")
    assert item["observation.state"] == episode.state[2].tolist()
    assert item["action"] == episode.action[2].tolist()
    assert item["belief"] == [0.25, 0.75]
    assert item["assist.alpha"] == 0.5
    assert item["timestamp"] == episode.timestamp[2]
    assert {
        seen["dtypes"][key] for key in ("observation.state", "action", "belief", "assist.alpha", "timestamp")
    } == {"torch.float32"}
    assert {seen["dtypes"][key] for key in ("index", "frame_index", "episode_index", "task_index")} == {
        "torch.int64"
    }
    assert seen["near"] == episode.state[1:4].tolist()
    assert seen["pad"] == [False, False, False]
    assert seen["last"] == [8, "stir"]


def test_a_gripper_reaches_lerobot(
    tmp_path: Path, lerobot: Callable[..., str], demonstrations: Demonstrations
) -> None:
    def gripped(episode: Episode) -> Episode:
        width = np.linspace(0.08, 0.06, len(episode.state))[:, None]
        gripper = {
            "observation.gripper_width": width,
            "observation.gripper_holding": (width < 0.062).astype(float),
            "action.gripper": np.zeros_like(width),
        }
        return replace(episode, extras={**episode.extras, **gripper})

    episodes = tuple(map(gripped, demonstrations.episodes))
    write_dataset(replace(demonstrations, episodes=episodes), tmp_path / "data")
    seen = json.loads(lerobot(READ, tmp_path / "data", 17))
    item = seen["item"]
    assert item["observation.gripper_width"] == np.float32(0.06)
    assert (item["observation.gripper_holding"], item["action.gripper"]) == (1.0, 0.0)
    found = import_demonstrations(tmp_path / "data").episodes[2].extras
    np.testing.assert_array_equal(found["observation.gripper_holding"].ravel(), [0, 0, 0, 0, 0, 0, 1])


def test_lerobot_lays_out_the_same_files_and_columns(
    tmp_path: Path, lerobot: Callable[..., str], demonstrations: Demonstrations
) -> None:
    import pyarrow.parquet as pq

    lerobot(WRITE, tmp_path / "theirs")
    write_dataset(demonstrations, tmp_path / "ours")
    files = {path.relative_to(tmp_path / "ours") for path in (tmp_path / "ours").rglob("*") if path.is_file()}
    assert files == {
        path.relative_to(tmp_path / "theirs")
        for path in (tmp_path / "theirs").rglob("*")
        if path.is_file() and "images" not in path.parts
    }
    ours, theirs = (
        json.loads((tmp_path / name / "meta/info.json").read_text()) for name in ("ours", "theirs")
    )
    assert list(ours) == [*theirs, "latentarm"]
    for key in ("codebase_version", "chunks_size", "data_files_size_in_mb", "data_path", "video_path"):
        assert ours[key] == theirs[key]
    for index in ("timestamp", "frame_index", "episode_index", "index", "task_index"):
        assert ours["features"][index] == theirs["features"][index]
    shared = (
        "observation.state",
        "action",
        "timestamp",
        "frame_index",
        "episode_index",
        "index",
        "task_index",
    )
    for file in sorted(path for path in files if path.suffix == ".parquet"):
        left, right = (pq.read_schema(tmp_path / name / file) for name in ("ours", "theirs"))
        for name in left.names:
            known = name in right.names
            assert known or not name.startswith("stats/") or name.split("/")[1] not in shared
            if known and "__" not in name:  # text may be long or short, which readers do not mind
                assert left.field(name).type == right.field(name).type


def test_we_read_what_lerobot_writes(tmp_path: Path, lerobot: Callable[..., str]) -> None:
    lerobot(WRITE, tmp_path / "theirs")
    import_to(tmp_path / "theirs", tmp_path / "ours")
    demonstrations = read_dataset(tmp_path / "ours")
    assert (demonstrations.rate_hz, demonstrations.robot) == (20.0, "toy")
    assert demonstrations.joint_names == ("j1", "j2", "j3")
    assert [episode.task for episode in demonstrations.episodes] == ["place", "pick", "place", "pick"]
    for index, episode in enumerate(demonstrations.episodes):
        frames = np.arange(5 + index)
        np.testing.assert_allclose(episode.timestamp, frames / 20, atol=1e-7)
        np.testing.assert_allclose(episode.state, np.tile(index + frames[:, None] / 10, 3), rtol=1e-6)
        assert list(episode.extras) == ["observation.force"]
        assert episode.action is None
    vouched = import_demonstrations(tmp_path / "theirs", options=ImportOptions(actions="joint_velocity"))
    np.testing.assert_array_equal(vouched.episodes[1].action, np.tile(np.arange(6)[:, None], 3))


WRITE_SO101 = """
import sys
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

joints = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
vector = {"dtype": "float32", "shape": (6,), "names": [f"{joint}.pos" for joint in joints]}
features = {"observation.state": vector, "action": vector}
dataset = LeRobotDataset.create(
    "local/data", fps=30, features=features, root=sys.argv[1], robot_type="so101_follower", use_videos=False
)
for episode in range(2):
    for frame in range(10):
        state = np.array([10, -20, 30, -40, 50, 5 * frame], dtype=np.float32) + episode
        dataset.add_frame({"observation.state": state, "action": state + 1, "task": "pick"})
    dataset.save_episode()
dataset.finalize()
"""


def test_an_so101_dataset_of_lerobot_is_imported(
    tmp_path: Path, lerobot: Callable[..., str], so101: Robot
) -> None:
    lerobot(WRITE_SO101, tmp_path / "theirs")
    with pytest.raises(UserError, match="--units deg"):
        import_demonstrations(tmp_path / "theirs", so101)
    first = import_demonstrations(tmp_path / "theirs", so101, ImportOptions(units=("deg",))).episodes[0]
    np.testing.assert_allclose(first.state[0], np.deg2rad([10, -20, 30, -40, 50]), rtol=1e-5)
    opening = first.extras["observation.gripper_opening"][:, 0]
    np.testing.assert_allclose(opening, 0.05 * np.arange(10), atol=1e-6)
    np.testing.assert_allclose(first.extras["action.target_position"][0, 0], np.deg2rad(11), rtol=1e-5)


def test_lerobot_does_not_see_an_episode_that_was_cut_off(
    tmp_path: Path,
    lerobot: Callable[..., str],
    demonstrations: Demonstrations,
    episode_of: Callable[..., Episode],
) -> None:
    """As a kill just before the commit leaves it: everything written but ``info.json``."""
    write_dataset(demonstrations, tmp_path / "data")
    info = (tmp_path / "data/meta/info.json").read_text()
    append_episode(tmp_path / "data", episode_of(3))
    (tmp_path / "data/meta/info.json").write_text(info)
    seen = json.loads(lerobot(READ, tmp_path / "data", 17))
    assert (seen["frames"], seen["episodes"], seen["lengths"]) == (18, 3, [5, 6, 7])
    assert seen["item"]["observation.state"] == read_dataset(tmp_path / "data").episodes[2].state[6].tolist()


def test_lerobot_and_we_append_to_the_same_dataset(
    tmp_path: Path,
    lerobot: Callable[..., str],
    demonstrations: Demonstrations,
    episode_of: Callable[..., Episode],
) -> None:
    write_dataset(demonstrations, tmp_path / "data")
    lerobot(EXTEND, tmp_path / "data")
    append_episode(tmp_path / "data", episode_of(4, samples=7))
    assert [len(episode.state) for episode in read_dataset(tmp_path / "data").episodes] == [5, 6, 7, 6, 7]
    seen = json.loads(lerobot(READ, tmp_path / "data", 30))
    assert (seen["frames"], seen["episodes"], seen["lengths"]) == (31, 5, [5, 6, 7, 6, 7])
    assert seen["item"]["observation.state"] == read_dataset(tmp_path / "data").episodes[4].state[6].tolist()


@pytest.mark.parametrize("name", ["panda_pick_banana", "panda_pick_cereal", "panda_pour_coffee"])
def test_the_real_recordings_and_a_drive_learned_from_them_reach_lerobot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lerobot: Callable[..., str], real: Path, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["import", str(real / f"{name}.npz"), "data"]) == 0
    seen = json.loads(lerobot(READ, tmp_path / "data", 1234))
    with np.load(real / f"{name}.npz", allow_pickle=False) as arrays:
        assert seen["frames"] == len(arrays["q"])
        assert seen["episodes"] == 15
        assert seen["item"]["observation.state"] == arrays["q"][1234].astype(np.float32).tolist()
        np.testing.assert_allclose(seen["mean"], arrays["q"].mean(axis=0), atol=1e-6)
        start = max(end for end in (0, *arrays["episode_ends"]) if end <= 1234)
        toggles = arrays["gripper_toggles"]
        count = np.count_nonzero((toggles >= start) & (toggles < 1234))
    wide = float(np.float32(0.08))
    assert seen["item"]["observation.gripper_width"] == (0.0 if count % 2 else wide)

    train = ["train", "--demonstrations", "data", "--model", "scl", "--seeds", "1", "--epochs", "20"]
    assert main([*train, "--context", "joints", "gripper", "--out", "run"]) == 0
    assert main(["drive", "run", "--drives", "1", "--time-limit-s", "60", "--record", "driven"]) in (0, 1)
    driven = read_dataset("driven").episodes
    closed = np.concatenate([one.extras["action.gripper"][:, 0] for one in driven]) == 0.0
    assert closed.any() == (len(toggles) > 0)
    # Where it was told to be closed, if it ever was, and else the last sample.
    index = int(closed.argmax()) or len(closed) - 1
    seen = json.loads(lerobot(READ, tmp_path / "driven", index))
    assert seen["frames"] == len(closed)
    assert seen["item"]["action.gripper"] == (0.0 if len(toggles) else wide)
    assert seen["shapes"]["observation.gripper_holding"] in ([], [1])
