"""Folds by default with few episodes, a verdict, and results that are not replaced silently."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Episode
from latentarm.demonstrations.dataset import write_dataset
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm.robots.catalogue import load_robot
from latentarm.runs.advice import next_step
from latentarm.runs.evaluating import OVER_FOLDS, evaluate_run
from latentarm.runs.folder import read_run
from latentarm.runs.options import EvaluateOptions, TrainOptions
from latentarm.runs.training import train_run
from latentarm.tasks.reach import Reach


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """At 5 Hz, since figures take as many steps as the demonstrations."""
    folder = tmp_path_factory.mktemp("evaluating")
    shown = Reach(load_robot("planar")).demonstrate(6, np.random.default_rng(0))
    episodes = tuple(Episode(one.state[::4], one.timestamp[::4], task=one.task) for one in shown.episodes)
    write_dataset(replace(shown, episodes=episodes, rate_hz=5.0), folder / "reach")
    train_run(TrainOptions((folder / "reach",), "pca", out=folder / "run", seeds=1))
    return folder / "run"


def test_with_few_episodes_each_is_held_out_once(run: Path, tmp_path: Path) -> None:
    evaluation = evaluate_run(EvaluateOptions(run, out=tmp_path, jobs=1))
    document = json.loads((tmp_path / "metrics.json").read_text())
    own = document["about"]["held_out"]
    assert own == list(read_run(run).held_out)
    assert sorted([*own, *(one for fold in document["about"]["folds"] for one in fold)]) == list(range(6))
    over_folds = {row.measure: row for row in evaluation.rows if row.condition == OVER_FOLDS}
    assert over_folds["search_noise_free_error"].n == 1 + len(document["about"]["folds"])
    assert over_folds["search_noise_free_error"].sd
    # A plane of motions is PCA itself, so it cannot be better than that.
    assert "PCA" in evaluation.verdict
    assert document["verdict"]["sentence"] == evaluation.verdict
    assert "latentarm " in evaluation.advice


def test_zero_folds_measure_the_own_split_alone(run: Path, tmp_path: Path) -> None:
    evaluation = evaluate_run(EvaluateOptions(run, out=tmp_path, jobs=1, folds=0))
    assert {row.condition for row in evaluation.rows} == {None}
    with pytest.raises(UserError, match="seed 0 there, 1 now"):
        evaluate_run(EvaluateOptions(run, out=tmp_path, seed=1, jobs=1, folds=0))
    assert evaluate_run(EvaluateOptions(run, out=tmp_path, jobs=1, folds=0)) == evaluation


@pytest.mark.parametrize(
    ("model", "way_back", "said"),
    [
        ("low_turning", True, "teleop run (beside the demonstrated motions its way back leads to them"),
        ("cvae", True, f"--model {DEFAULT_MODEL} --way-back-m 0"),
        ("cvae", False, f"--model {DEFAULT_MODEL} --way-back-m 0"),
        ("low_turning", False, "latentarm compare"),
    ],
)
def test_a_model_that_does_not_go_back_is_driven_or_followed_by_one_that_does(
    model: str, way_back: bool, said: str
) -> None:
    assert said in next_step(model, way_back, "run", "eat", frozenset({"reversal"}))


@pytest.mark.parametrize(("folds", "said"), [(1, "at least 2"), (-1, "at least 2"), (7, "too few")])
def test_folds_that_cannot_be_are_refused(run: Path, tmp_path: Path, folds: int, said: str) -> None:
    with pytest.raises(UserError, match=said):
        evaluate_run(EvaluateOptions(run, out=tmp_path, jobs=1, folds=folds))
    assert not list(tmp_path.iterdir())
