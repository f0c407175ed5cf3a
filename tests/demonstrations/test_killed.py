"""A writer that dies at any moment costs at most the episode that it was writing."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import append_episode, read_dataset, write_dataset

MakeEpisode = Callable[..., Episode]

WRITERS = """
import json, os, sys
from pathlib import Path
import numpy as np
from latentarm.demonstrations.dataset import append_episode, read_dataset
from latentarm.core.types import Episode

renames = 0
rename = Path.replace

def write(path, first, fatal, after):
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
        task = f"task {index}"
        append_episode(path, Episode(state, time, np.zeros((samples, 3)), task=task, extras=extras))
        print(index, flush=True)

for line in sys.stdin:
    path, first, fatal, moment = json.loads(line)
    child = os.fork()
    if not child:
        print(os.getpid(), flush=True)
        write(Path(path), first, fatal, moment == "after")
    print("ended", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
"""Writers, each in a process of its own; pyarrow is imported once, before they are forked."""


class Writers:
    """Starts writers, one after the other."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        self._orders, self._answers = process.stdin, process.stdout

    def start(self, path: Path, first: int, fatal: int = 0, moment: str = "before") -> int:
        """Its process id. It appends episodes from ``first`` on, and dies at its rename number ``fatal``."""
        self._orders.write(json.dumps([str(path), first, fatal, moment]) + "\n")
        self._orders.flush()
        return int(self._answers.readline())

    def first_of(self) -> int:
        """Wait for its first episode; its number."""
        return int(self._answers.readline())

    def end(self) -> tuple[int, list[int]]:
        """Its exit code, and the numbers of the episodes that it has acknowledged since."""
        heard: list[int] = []
        while not (line := self._answers.readline()).startswith("ended"):
            heard.append(int(line))
        return int(line.split()[1]), heard


@pytest.fixture(scope="module")
def writers() -> Iterator[Writers]:
    with subprocess.Popen(
        [sys.executable, "-c", WRITERS],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    ) as process:
        yield Writers(process)


def check_whole(path: Path, original: int, acknowledged: int) -> int:
    """Every acknowledged episode is there, and every episode that is there is whole."""
    episodes = read_dataset(path).episodes
    assert len(episodes) >= acknowledged
    for index, episode in enumerate(episodes[original:], start=original):
        assert episode.state.shape == (5 + index % 7, 3)
        assert np.all(episode.state == index)
        assert episode.task == f"task {index}"
    return len(episodes)


def kill_again_and_again(writers: Writers, path: Path, kills: int, demonstrations: Demonstrations) -> None:
    write_dataset(demonstrations, path)
    original = len(demonstrations.episodes)
    whole = original
    rng = np.random.default_rng(7)
    for _ in range(kills):
        writer = writers.start(path, whole)
        first = writers.first_of()
        time.sleep(rng.uniform(0, 0.15))
        os.kill(writer, signal.SIGKILL)
        code, heard = writers.end()
        assert code == -signal.SIGKILL
        whole = check_whole(path, original, max([whole, first, *heard]) + 1)


def test_killed_at_random_moments(writers: Writers, tmp_path: Path, demonstrations: Demonstrations) -> None:
    kill_again_and_again(writers, tmp_path / "data", 4, demonstrations)


@pytest.mark.slow
def test_killed_at_thirty_random_moments(
    writers: Writers, tmp_path: Path, demonstrations: Demonstrations
) -> None:
    kill_again_and_again(writers, tmp_path / "data", 30, demonstrations)


# After one rename the folder is as before the next.
@pytest.mark.parametrize(("step", "moment"), [*((step, "before") for step in range(1, 6)), (5, "after")])
def test_killed_at_every_step_of_an_append(
    writers: Writers,
    tmp_path: Path,
    demonstrations: Demonstrations,
    episode_of: MakeEpisode,
    step: int,
    moment: str,
) -> None:
    path = tmp_path / "data"
    write_dataset(demonstrations, path)
    original = len(demonstrations.episodes)
    writers.start(path, original, fatal=step, moment=moment)
    assert writers.end()[0] == 9
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
