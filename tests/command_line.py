"""Fixtures of tests that run commands."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.demonstrations.dataset import write_dataset
from latentarm.tasks.table_top import TableTop


@pytest.fixture(scope="session")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A NumPy archive as people bring it: seven short demonstrations at the table."""
    demonstrations = TableTop().demonstrate(7, np.random.default_rng(0))
    path = tmp_path_factory.mktemp("recording") / "recording.npz"
    states = [episode.state[::4] for episode in demonstrations.episodes]
    ends = np.cumsum([len(state) for state in states])
    np.savez(path, q=np.concatenate(states), episode_ends=ends, rate_hz=5.0)
    return path


@pytest.fixture
def run(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., tuple[int, str, str]]:
    """Run one command in this process: its exit code, standard output and standard error."""
    monkeypatch.setenv("COLUMNS", "100")

    def run(*words: object) -> tuple[int, str, str]:
        capsys.readouterr()
        try:
            code = main([str(word) for word in words])
        except SystemExit as stopped:  # the parser's own way out
            code = int(stopped.code or 0)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that the command runs in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def made(recording: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What commands begin with, made once: the datasets ``eat`` and ``table``, and a run ``mine`` on it."""
    folder = tmp_path_factory.mktemp("made")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(["import", str(recording), "eat"]) == 0
        write_dataset(TableTop().demonstrate(6, np.random.default_rng(0)), Path("table"))
        hardly = ["--model", "cae", "--seeds", "2", "--epochs", "2", "--hidden", "8"]
        assert main(["train", "--demonstrations", "table", *hardly, "--out", "mine"]) == 0
    return folder


def copied(name: str, made: Path, workplace: Path) -> Path:
    shutil.copytree(made / name, workplace / name)
    return Path(name)


@pytest.fixture
def eat(made: Path, workplace: Path) -> Path:
    """The recording, imported as ``eat``."""
    return copied("eat", made, workplace)


@pytest.fixture
def table(made: Path, workplace: Path) -> Path:
    """Six demonstrations at the table, with goals, called ``table``."""
    return copied("table", made, workplace)


@pytest.fixture
def trained(made: Path, table: Path, workplace: Path) -> Path:
    """A run called ``mine`` on ``table``: two seeds of a cAE, hardly trained."""
    return copied("mine", made, workplace)
