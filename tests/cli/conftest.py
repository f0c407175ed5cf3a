from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.tasks.table_top import TableTop


@pytest.fixture(scope="session")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A NumPy archive as people bring it: seven short demonstrations at the table."""
    demonstrations = TableTop().demonstrate(7, np.random.default_rng(0))
    path = tmp_path_factory.mktemp("recording") / "recording.npz"
    states = [episode.state[::2] for episode in demonstrations.episodes]
    ends = np.cumsum([len(state) for state in states])
    np.savez(path, q=np.concatenate(states), episode_ends=ends, rate_hz=10.0)
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
