"""What a dataset's texts and a file's name hold is shown on the terminal, and not obeyed."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.dataset import write_dataset
from latentarm.tasks.table_top import TableTop

Run = Callable[..., tuple[int, str, str]]

HOSTILE = "[/nope] :smile: \x1b]0;owned\x07\x9b2J\u202e $\\frac{$"


@pytest.fixture
def hostile_dataset(workplace: Path) -> Path:
    """A dataset whose every text would do something to a terminal, a table or a figure."""
    task = TableTop()
    made = task.demonstrate(2, np.random.default_rng(0))
    names = tuple(f"{index}{HOSTILE}" for index in range(task.robot.dof))
    hostile = replace(
        made,
        episodes=tuple(replace(episode, task=HOSTILE) for episode in made.episodes),
        joint_names=names,
        robot=HOSTILE,
        goals=tuple(replace(goal, name=HOSTILE) for goal in made.goals),
    )
    write_dataset(hostile, workplace / "hostile")
    return workplace / "hostile"


@pytest.mark.filterwarnings("ignore:Glyph")
def test_a_dataset_is_inspected_whatever_its_texts(
    run: Run, hostile_dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    code, out, err = run("inspect", hostile_dataset)
    assert code == 0, err
    assert "[/nope] :smile: \\x1b]0;owned\\x07\\x9b2J\\u202e" in out
    assert "\x1b]" not in out + err
    assert (hostile_dataset.with_name("hostile-figures") / "joints.png").is_file()

    code, out, _ = run("inspect", hostile_dataset, "--json")
    assert code == 0
    assert any(HOSTILE in str(row["condition"]) for row in json.loads(out))


@pytest.mark.parametrize(
    "words",
    [
        ("inspect", "\x1b]0;owned\x07\nsecond line"),
        ("train", "--demonstrations", "hostile"),
        ("robots", "\x1b[2J.urdf"),
    ],
)
def test_a_refusal_is_one_plain_sentence(run: Run, hostile_dataset: Path, words: tuple[str, ...]) -> None:
    info = hostile_dataset / "meta/info.json"
    document = json.loads(info.read_text())
    document["codebase_version"] = HOSTILE + "x" * 10_000
    info.write_text(json.dumps(document))
    code, out, err = run(*words)
    assert (code, out) == (2, "")
    assert err.startswith("latentarm: ")
    assert err.count("\n") == 1
    assert len(err) < 1100
    assert not set(err) & set("\x1b\x07\x9b\u202e")
