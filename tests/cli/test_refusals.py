"""What the user can mend: exit code 2, one sentence, nothing left behind."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

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
    "no drives": (("drive", "--drives", "0"), "at least one drive"),
    "table for another arm": (("drive", "--task", "table_top", "--robot", "planar"), "Panda"),
    "held-out episodes of nothing": (("drive", "--task", "held_out"), "run"),
    "demo over something else": (("demo", "--out", "."), "not empty"),
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
    "words", [("fly",), ("train",), ("train", "--demonstrations", "d", "--model", "gan")]
)
def test_words_that_no_command_has(run: Run, words: tuple[str, ...]) -> None:
    code, _, err = run(*words)
    assert code == 2
    assert err
