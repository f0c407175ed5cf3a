"""`latentarm train --goal-entropy`: the loss of equation 16 from the command line."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.dataset import write_dataset
from latentarm_research.tasks.two_cups import PlanarTwoCups

Run = Callable[..., tuple[int, str, str]]
CUPS = ("--demonstrations", "cups", "--latent-dim", "1", "--context", "state_belief", "--seeds", "1")
TRAIN = ("train", *CUPS)


@pytest.fixture(scope="module")
def datasets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with demonstrations of two goals, and with the same of none."""
    folder = tmp_path_factory.mktemp("datasets")
    shown = PlanarTwoCups().demonstrate(4, np.random.default_rng(0))
    write_dataset(shown, folder / "cups")
    write_dataset(replace(shown, goals=()), folder / "aimless")
    return folder


@pytest.fixture
def cups(datasets: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(datasets)
    return datasets


@pytest.mark.usefixtures("cups")
def test_the_run_says_what_it_was_trained_with(run: Run) -> None:
    code, _, err = run(*TRAIN, "--model", "cae", "--epochs", "2", "--goal-entropy", "5", "--out", "run")
    assert code == 0, err
    assert json.loads(Path("run/config.json").read_text())["goal_entropy"] == 5.0


@pytest.mark.usefixtures("cups")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((*TRAIN, "--model", "cae", "--goal-entropy", "-1"), "zero or more"),
        ((*TRAIN, "--model", "pca", "--goal-entropy", "1"), "closed form"),
        (("train", "--demonstrations", "aimless", "--goal-entropy", "1"), "needs two or more"),
    ],
)
def test_what_cannot_be_trained_is_refused(run: Run, words: tuple[str, ...], said: str) -> None:
    code, _, err = run(*words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
    assert not Path("runs").exists()
