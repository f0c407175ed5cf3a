"""Training on several datasets, and warnings of an import that later commands repeat."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.dataset import read_dataset
from latentarm.robots.panda import panda

Run = Callable[..., tuple[int, str, str]]


def record(path: Path, episodes: int, rate_hz: float = 20.0) -> Path:
    time = np.linspace(0, 3, 40)[:, None]
    one, other = np.array([[0.3, 0.2, 0.1, 0.3, 0, 0, 0.1], [0, 0.1, 0.2, -0.2, 0.3, 0.3, 0]])
    ways = [np.sin(time) * one + np.sin((2 + index % 3) * time) * other for index in range(episodes)]
    states = [panda().home + way for way in ways]
    np.savez(path, q=np.concatenate(states), episode_ends=40 * np.arange(1, episodes + 1), rate_hz=rate_hz)
    return path


def test_several_datasets_train_one_model(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, episodes in (("a", 3), ("b", 4)):
        assert run("import", record(Path(f"{name}.npz"), episodes), name)[0] == 0
    train = ("train", "--demonstrations", "a", "b", "--model", "pca", "--seeds", 1)
    assert run(*train)[0] == 0
    joined = read_dataset("runs/a-b-pca/demonstrations")
    apart = [*read_dataset("a").episodes, *read_dataset("b").episodes]
    assert len(joined.episodes) == 7
    for one, other in zip(joined.episodes, apart, strict=True):
        np.testing.assert_array_equal(one.state, other.state)
    assert run("evaluate", "runs/a-b-pca", "--folds", 0)[0] == 0
    # A training that was broken off has left its datasets; another one's are not touched.
    Path("runs/a-b-pca/config.json").unlink()
    assert run(*train)[0] == 0
    Path("runs/a-b-pca/config.json").unlink()
    code, _, err = run("train", "--demonstrations", "b", "a", "--model", "pca", "--out", "runs/a-b-pca")
    assert (code, "already exists" in err) == (2, True)


def test_datasets_that_do_not_fit_each_other_are_refused(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    np.savez("c.npz", q=np.zeros((40, 5)) + 0.01 * np.arange(40)[:, None], episode_ends=[40], rate_hz=20.0)
    assert run("import", record(Path("a.npz"), 3), "a")[0] == 0
    assert run("import", record(Path("b.npz"), 3, rate_hz=50.0), "b")[0] == 0
    assert run("import", "c.npz", "c", "--robot", "planar")[0] == 0
    code, _, err = run("train", "--demonstrations", "a", "c")
    assert (code, "c and a differ in the robot: they cannot be one dataset" in err) == (2, True)
    code, _, err = run("train", "--demonstrations", "a", "b")
    assert (code, "20 Hz" in err and "50 Hz" in err and "--resample-hz" in err) == (2, True)


def test_inspect_and_train_repeat_what_import_warned_of(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    warned = "are faster than the robot's limits"
    for command in (
        ("import", record(Path("a.npz"), 3, rate_hz=100.0), "a"),
        ("inspect", "a", "--json"),
        ("train", "--demonstrations", "a", "--model", "pca", "--seeds", 1, "--json"),
    ):
        code, out, err = run(*command)
        assert code == 0
        assert f"{warned}" in err, command
    json.loads(out)
    assert warned in json.loads(Path("runs/a-pca/config.json").read_text())["warnings"][0]
