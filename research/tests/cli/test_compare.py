import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm_research.studies.study import Report
from latentarm_research.tasks.planar.circle import Circle
from result_rows import rows_in

Run = Callable[..., tuple[int, str, str]]


TINY = ("--preset", "smoke", "--folds", 2, "--reach-pairs", 2, "--jobs", 1)


def test_the_smallest_comparison_for_people_and_for_machines(
    run: Run, eat: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ("compare", "--demonstrations", eat, *TINY, "--models", "pca", "cae", "--ours", "cae")
    code, out, err = run(*command)
    assert code == 0
    assert "eat, noise 0.01 rad" in out
    assert "PCA" in out
    assert "compared/results.md" in out
    assert "cells" in err
    written = rows_in(Path("compared/results.json"))
    report = Report(written, "", {})
    monkeypatch.setattr("latentarm_research.studies.study.run_study", lambda *asked: report)
    code, out, err = run(*command, "--json")
    assert code == 0
    assert json.loads(out) == [row.as_json() for row in written]
    page = Path("compared/results.md").read_text()
    assert "latentarm compare --demonstrations eat --preset smoke --models pca cae" in page


REFUSED = {
    "no such dataset": (("--demonstrations", "nowhere"), "nowhere"),
    "unknown model": (("--demonstrations", "eat", "--models", "gan"), "'gan': choose from pca"),
    "unknown model of ours": (("--demonstrations", "eat", "--ours", "gan"), "'gan'"),
    "a model twice": (("--demonstrations", "eat", "--models", "cae", "cae"), "none twice"),
    "a dataset twice": (("--demonstrations", "eat", "eat"), "none twice"),
    "noise that is none": (("--demonstrations", "eat", "--noise", "nan"), "noise is nan"),
    "noise below zero": (("--demonstrations", "eat", "--noise", "-0.1"), "noise is -0.1"),
    "one fold": (("--demonstrations", "eat", "--folds", "1"), "folds is 1"),
    "no seeds": (("--demonstrations", "eat", "--seeds", "0"), "seeds is 0"),
    "no pairs": (("--demonstrations", "eat", "--reach-pairs", "0"), "at least 1"),
    "fewer episodes than folds": (
        ("--demonstrations", "eat", "--folds", "8"),
        "eat: .* fewer than the 8 folds",
    ),
    "another robot": (("--demonstrations", "eat", "circles"), "one robot"),
    "no robot": (("--demonstrations", "nameless"), "name its robot"),
    "an unknown robot": (("--demonstrations", "foreign"), "asimo"),
    "over something else": (("--demonstrations", "eat", "--out", "eat"), "not an earlier run"),
}


@pytest.fixture(scope="module")
def datasets(made: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of datasets, some of which cannot be compared on."""
    folder = tmp_path_factory.mktemp("datasets")
    shutil.copytree(made / "eat", folder / "eat")
    shown = read_dataset(made / "eat")
    write_dataset(replace(shown, robot=""), folder / "nameless")
    write_dataset(replace(shown, robot="asimo"), folder / "foreign")
    write_dataset(Circle().demonstrate(5, np.random.default_rng(0)), folder / "circles")
    return folder


@pytest.mark.parametrize("case", REFUSED)
def test_refused_in_one_sentence(
    run: Run, datasets: Path, case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(datasets)  # where nothing is left behind
    words, said = REFUSED[case]
    before = sorted(Path().rglob("*"))
    code, out, err = run("compare", *words)
    assert code == 2
    assert out == ""
    assert err.startswith("latentarm: ")
    assert err.count("\n") == 1
    assert re.search(said, err)
    assert sorted(Path().rglob("*")) == before
