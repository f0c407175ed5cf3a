"""No command asks for an option that it does not have, and the tool is named once."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

Run = Callable[..., tuple[int, str, str]]

FORK = """<mujoco><worldbody>
<body name="upper"><joint name="a" axis="0 0 1" range="-90 90"/><geom size="0.02"/>
<body name="lower" pos="0.4 0 0"><joint name="b" axis="0 1 0" range="-90 90"/><geom size="0.02"/>
<body name="plate" pos="0.3 0 0"><geom size="0.02"/></body>
<body name="hook" pos="0.2 0.1 0"><geom size="0.02"/></body>
</body></body></worldbody></mujoco>"""
PLATE = ("--robot", "fork.xml", "--end-effector", "plate")


@pytest.fixture
def fork(workplace: Path) -> Path:
    """An arm with two last bodies, and a recording of it."""
    Path("fork.xml").write_text(FORK)
    time_s = np.arange(80) / 10.0
    states = np.stack([0.6 * np.sin(0.4 * time_s), 0.5 * np.cos(0.3 * time_s)], axis=1)
    np.savez("fork.npz", q=np.tile(states, (4, 1)), episode_ends=80 * np.arange(1, 5), rate_hz=10.0)
    return workplace


def forget(document: Path) -> None:
    """As it was written before the tool was kept."""
    content = json.loads(document.read_text())
    for part in (content, content.get("latentarm", {}), content.get("run", {})):
        if "end_effector" in part:
            part["end_effector"] = None
    document.write_text(json.dumps(content))


def test_the_tool_is_named_at_import_and_known_from_then_on(run: Run, fork: Path) -> None:
    code, _, err = run("import", "fork.npz", "forked", "--robot", "fork.xml")
    assert code == 2
    assert "--end-effector, one of hook (2 joints), plate (2 joints)" in err
    assert run("import", "fork.npz", "forked", *PLATE)[0] == 0
    assert json.loads(Path("forked/meta/info.json").read_text())["latentarm"]["end_effector"] == "plate"
    assert "–" not in run("inspect", "forked")[1]  # the tool's path is known
    assert run("train", "--demonstrations", "forked", "--model", "pca", "--out", "learned")[0] == 0
    assert run("evaluate", "learned", "--folds", 0)[0] == 0
    code, _, err = run("drive", "learned", "--drives", 1, "--time-limit-s", 0.3, "--json", "--out", "driven")
    assert code in (0, 1), err
    assert '"end_effector": "plate"' in Path("driven/drives.json").read_text()


def test_no_sentence_names_an_option_that_the_command_lacks(run: Run, fork: Path) -> None:
    """Datasets and runs from before the tool was kept."""
    run("import", "fork.npz", "forked", *PLATE)
    run("train", "--demonstrations", "forked", "--model", "pca", "--out", "learned")
    forget(Path("forked/meta/info.json"))
    forget(Path("learned/config.json"))
    calls = (
        ("robots", "fork.xml"),
        ("drive", "--robot", "fork.xml"),
        ("import", "fork.npz", "again", "--robot", "fork.xml"),
        ("inspect", "forked"),
        ("train", "--demonstrations", "forked", "--out", "other"),
        ("compare", "--demonstrations", "forked", "--preset", "smoke", "--jobs", "1"),
        ("evaluate", "learned"),
        ("align", "learned", "--name", "ada", "--simulated"),
        ("drive", "learned", "--out", "driven"),
        ("teleop", "learned", "--port", "0"),
    )
    for words in calls:
        code, _, err = run(*words)
        _, offered, more = run(words[0], "--help")
        assert "hook" in err, words
        assert code == (0 if words[0] == "inspect" else 2), words
        # What is asked for outside a whole command in backticks must be this command's own.
        asked = re.findall(r"--[a-z-]+", re.sub(r"`[^`]*`", "", err))
        assert all(option in offered + more for option in asked), (words, err)


def test_the_command_that_an_old_dataset_is_answered_with_works(run: Run, fork: Path) -> None:
    run("import", "fork.npz", "forked", *PLATE)
    forget(Path("forked/meta/info.json"))
    _, _, err = run("compare", "--demonstrations", "forked", "--preset", "smoke")
    (command,) = re.findall(r"`latentarm ([^`]*)`", err)
    words = command.replace("NEW", "anew").replace("NAME", "plate").split()
    assert run(*words)[0] == 0
    assert json.loads(Path("anew/meta/info.json").read_text())["latentarm"]["end_effector"] == "plate"


def test_limits_are_kept_with_the_dataset_and_the_run(run: Run, fork: Path) -> None:
    Path("limits.toml").write_text("[joints.a]\nvelocity_deg_per_s = 90\n")
    assert run("import", "fork.npz", "forked", *PLATE, "--limits", "limits.toml")[0] == 0
    run("train", "--demonstrations", "forked", "--model", "pca", "--out", "learned")
    for document in ("forked/meta/info.json", "learned/config.json"):
        assert "velocity_rad_per_s" in Path(document).read_text()
    code, out, _ = run("robots", *PLATE[1:], "--limits", "limits.toml", "--json")
    assert code == 0
    first, second = json.loads(out)[0]["joints"]
    assert (first["source"]["velocity"], second["source"]["velocity"]) == ("limits_file", "assumed")
    assert first["velocity"] == pytest.approx(np.pi / 2)
    Path("limits.toml").write_text("[joints.c]\nvelocity_deg_per_s = 90\n")
    code, _, err = run("drive", *PLATE, "--limits", "limits.toml")
    assert code == 2
    assert "the joint 'c'" in err
