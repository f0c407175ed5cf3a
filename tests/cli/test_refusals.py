"""What the user can mend: exit code 2, one sentence, nothing left behind."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.tasks.table_top import TableTop

Run = Callable[..., tuple[int, str, str]]

REFUSED = {
    "no such file": (("import", "nowhere.npz", "out"), "nowhere.npz"),
    "foreign file": (("import", "text.npz", "out"), "text.npz"),
    "no dataset": (("inspect", "nowhere"), "nowhere"),
    "no dataset to train on": (("train", "--demonstrations", "nowhere"), "nowhere"),
    "no run": (("evaluate", "nowhere"), "nowhere"),
    "no run to drive": (("drive", "nowhere"), "nowhere"),
    "latent actions without a run": (
        ("drive", "--controller", "latent"),
        "needs? a trained run|need a trained run",
    ),
    "unknown robot": (("robots", "asimo"), "asimo"),
    "end-effector of a named robot": (("robots", "panda", "--end-effector", "hand"), "panda"),
    "no drives": (("drive", "--drives", "0"), "at least 1"),
    "no drives in the demo": (("demo", "--drives", "0"), "at least 1"),
    "a demo over a file": (("demo", "--out", "text.npz"), "text.npz"),
    "a seed below zero": (("drive", "--seed", "-1"), "seed"),
    "no end of time": (("drive", "--time-limit-s", "inf"), "time limit"),
    "no time": (("drive", "--time-limit-s", "0"), "time limit"),
    "rationality without measure": (("drive", "--beta", "nan"), "beta"),
    "alpha without help": (("drive", "--alpha", "0.5"), "latent_assist"),
    "arbitration without help": (("drive", "--arbitration", "confidence"), "latent_assist"),
    "alpha with published help": (
        ("drive", "--assistance", "hindsight", "--alpha", "0.5"),
        "hindsight has no alpha",
    ),
    "more than all help": (("drive", "--controller", "latent_assist", "--alpha", "1.5"), r"in \[0, 1\]"),
    "alpha without measure": (("drive", "--controller", "latent_assist", "--alpha", "nan"), "alpha"),
    "nothing to time": (("bench", "--repeats", "0"), "at least 1"),
    "table for another arm": (("drive", "--task", "table_top", "--robot", "planar"), "robot panda"),
    "held-out episodes of nothing": (("drive", "--task", "held_out"), "run"),
    "a study over something else": (
        ("reproduce", "properties", "--preset", "smoke", "--out", "."),
        "not an earlier run",
    ),
    "a study on no process": (("reproduce", "properties", "--jobs", "0"), "jobs is 0"),
    "demo over something else": (("demo", "--out", "."), "not an earlier run"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_in_one_sentence(run: Run, workplace: Path, case: str) -> None:
    words, said = REFUSED[case]
    Path("text.npz").write_text("this is no archive")
    before = sorted(Path().rglob("*"))
    code, out, err = run(*words)
    assert code == 2
    assert out == ""
    assert err.startswith("latentarm: ")
    assert err.count("\n") == 1
    assert re.search(said, err)
    assert "Traceback" not in err
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize(
    "words",
    [
        ("fly",),
        ("train",),
        ("train", "--demonstrations", "d", "--model", "gan"),
        ("reproduce",),
        ("reproduce", "everything"),
        ("reproduce", "properties", "--task", "square"),
        ("reproduce", "properties", "--preset", "huge"),
        ("reproduce", "properties", "--backend", "slurm"),
    ],
)
def test_words_that_no_command_has(run: Run, words: tuple[str, ...]) -> None:
    code, _, err = run(*words)
    assert code == 2
    assert err


def test_a_run_knows_its_dataset(run: Run, eat: Path, table: Path) -> None:
    run("train", "--demonstrations", "eat", "--model", "pca", "--out", "mine")
    Path("eat").rename("moved")
    assert run("evaluate", "mine", "--demonstrations", "moved", "--folds", 0)[0] == 0

    code, _, err = run("evaluate", "mine", "--demonstrations", table, "--folds", 0)
    assert code == 2
    assert "not the dataset" in err


def test_a_decoder_with_beliefs_is_not_driven_to_foreign_goals(run: Run, table: Path) -> None:
    command = ("train", "--demonstrations", "table", "--model", "scl", "--epochs", 1, "--seeds", 1)
    run(*command, "--context", "state_belief")
    code, _, err = run("drive", "runs/table-scl", "--task", "reach")
    assert code == 2
    assert "goals" in err


def test_a_recording_without_a_rate_is_imported_when_told(run: Run, workplace: Path) -> None:
    states = TableTop().demonstrate(2, np.random.default_rng(0)).episodes[0].state
    np.savez("bare.npz", q=states, episode_ends=[len(states)])
    code, _, err = run("import", "bare.npz", "bare")
    assert code == 2
    assert "rate" in err
    assert run("import", "bare.npz", "bare", "--rate-hz", 20, "--instruction", "eat")[0] == 0


def test_a_folder_that_is_a_file(run: Run, eat: Path) -> None:
    Path("file").write_text("")
    code, _, err = run("train", "--demonstrations", "eat", "--model", "pca", "--out", "file/run")
    assert code == 2
    assert "file" in err
    assert "Traceback" not in err


@pytest.mark.parametrize("reader", ["head -c 1", "cat > /dev/full"])
def test_a_reader_who_leaves_and_a_full_disk(reader: str) -> None:
    command = f"{sys.executable} -m latentarm robots panda --json | {reader}"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)  # noqa: S602
    assert "Traceback" not in done.stderr


def test_a_terminal_without_our_letters() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "latentarm", "robots", "panda"],
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
