"""A writer that dies at any moment costs at most the episode that it was writing."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.dataset import append_episode, read_dataset, write_dataset
from latentarm.types import Demonstrations, Episode

MakeEpisode = Callable[..., Episode]

WRITER = """
import os, sys
from pathlib import Path
import numpy as np
from latentarm.demonstrations.dataset import append_episode, read_dataset
from latentarm.types import Episode

path, first, fatal, after = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4] == "after"
renames = 0
rename = Path.replace

def counted(source, target):
    global renames
    renames += 1
    if renames == fatal and not after:
        os._exit(9)
    result = rename(source, target)
    if renames == fatal:
        os._exit(9)
    return result

Path.replace = counted
for index in range(first, first + 100000):
    samples = 5 + index % 7
    state = np.full((samples, 3), float(index))
    extras = {"belief": np.full((samples, 2), 0.5), "assist.alpha": np.zeros((samples, 1))}
    time = np.arange(samples) / 10
    append_episode(path, Episode(state, time, np.zeros((samples, 3)), task=f"task {index}", extras=extras))
    print(index, flush=True)
"""


def start_writer(path: Path, first: int, fatal: int = 0, moment: str = "before") -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path), str(first), str(fatal), moment],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )


def check_whole(path: Path, original: int, acknowledged: int) -> int:
    """Every acknowledged episode is there, and every episode that is there is whole."""
    episodes = read_dataset(path).episodes
    assert len(episodes) >= acknowledged
    for index, episode in enumerate(episodes[original:], start=original):
        assert episode.state.shape == (5 + index % 7, 3)
        assert np.all(episode.state == index)
        assert episode.task == f"task {index}"
    return len(episodes)


def kill_again_and_again(path: Path, kills: int, demonstrations: Demonstrations) -> None:
    write_dataset(demonstrations, path)
    original = len(demonstrations.episodes)
    whole = original
    rng = np.random.default_rng(7)
    for _ in range(kills):
        with start_writer(path, whole) as writer:
            assert writer.stdout is not None
            writer.stdout.readline()
            time.sleep(rng.uniform(0, 0.15))
            writer.send_signal(signal.SIGKILL)
            heard = [int(line) for line in writer.stdout.read().split()]
        whole = check_whole(path, original, max([whole, *heard]) + 1)


def test_killed_at_random_moments(tmp_path: Path, demonstrations: Demonstrations) -> None:
    kill_again_and_again(tmp_path / "data", 4, demonstrations)


@pytest.mark.slow
def test_killed_at_thirty_random_moments(tmp_path: Path, demonstrations: Demonstrations) -> None:
    kill_again_and_again(tmp_path / "data", 30, demonstrations)


@pytest.mark.parametrize("moment", ["before", "after"])
@pytest.mark.parametrize("step", range(1, 6))
def test_killed_at_every_step_of_an_append(
    tmp_path: Path, demonstrations: Demonstrations, episode_of: MakeEpisode, step: int, moment: str
) -> None:
    path = tmp_path / "data"
    write_dataset(demonstrations, path)
    original = len(demonstrations.episodes)
    with start_writer(path, original, fatal=step, moment=moment) as writer:
        writer.communicate(timeout=60)
    assert writer.returncode == 9
    committed = step == 5 and moment == "after"
    whole = check_whole(path, original, original)
    assert whole == original + committed

    append_episode(path, episode_of(whole, task="after the kill"))
    assert read_dataset(path).episodes[-1].task == "after the kill"
    assert not list(path.rglob(".*.part"))


def test_an_orphaned_data_file_is_removed(
    tmp_path: Path, demonstrations: Demonstrations, episode_of: MakeEpisode
) -> None:
    path = tmp_path / "data"
    write_dataset(demonstrations, path)
    orphan = path / "data/chunk-000/file-001.parquet"
    orphan.write_bytes((path / "data/chunk-000/file-000.parquet").read_bytes())
    append_episode(path, episode_of(3))
    assert not orphan.exists()
    assert len(read_dataset(path).episodes) == 4
