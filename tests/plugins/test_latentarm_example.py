"""A distribution of somebody else: its model, task, arm and belief are used like ours.

Nothing is installed. A folder with the metadata that pip would write stands before the others on the path of
the processes that are started here.
"""

import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.sync.client import connect

from latentarm.demonstrations.dataset import read_dataset
from registered import register

HERE = Path(__file__).parent / "latentarm_example"
SOURCE = Path(__file__).parents[2] / "src"

SESSION = """
import contextlib, io, json, sys
from pathlib import Path
import numpy as np
import pytest
from latentarm import make_task
from latentarm.cli import main
from latentarm.demonstrations.dataset import write_dataset

said = {}
for name, words in json.loads(sys.argv[1]).items():
    if name == "train":
        write_dataset(make_task("two_buttons").demonstrate(6, np.random.default_rng(0)), "buttons")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        try:
            code = pytest.main(words) if name == "contracts" else main(words)
        except SystemExit as ended:
            code = ended.code
    said[name] = {"code": int(code), "out": out.getvalue()}
Path("said.json").write_text(json.dumps(said))
"""
COMMANDS = {
    **{f"{command} help": (command, "--help") for command in ("train", "drive", "teleop")},
    "train": (
        *("train", "--demonstrations", "buttons", "--model", "straight", "--task", "two_buttons"),
        *("--seeds", "1", "--epochs", "2", "--hidden", "8", "--out", "mine"),
    ),
    "evaluate": ("evaluate", "mine", "--folds", "0", "--json"),
    "drive": (
        *("drive", "mine", "--arm", "counting", "--belief", "nearness", "--controller", "latent_assist"),
        *("--drives", "1", "--jobs", "1", "--time-limit-s", "1", "--out", "driven"),
    ),
    # Laws that take thousands of steps are tested on our own beliefs.
    "contracts": (
        *("-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", "test_theirs.py"),
        *("-k", "not ten_thousand_steps and not change_their_mind"),
    ),
}
"""What is said to one process, one after the other: only its imports take long."""

CONTRACTS = """
import pytest
from latentarm_example.arm import CountingArm
from latentarm_example.belief import NearnessBelief
from latentarm_example.task import TwoButtons
from latentarm_example.training import Straight
from latentarm.testing.arms import ArmContract
from latentarm.testing.beliefs import BeliefContract
from latentarm.testing.models import ModelContract
from latentarm.testing.tasks import TaskContract

class TestArm(ArmContract):
    tolerance_rad = 2e-5
    @pytest.fixture
    def make(self):
        return CountingArm

class TestBelief(BeliefContract):
    @pytest.fixture
    def rule(self):
        return NearnessBelief

class TestModel(ModelContract):
    @pytest.fixture
    def estimator(self):
        return Straight

class TestTask(TaskContract):
    @pytest.fixture
    def task(self):
        return TwoButtons()
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder to work in, and the distribution's metadata in ``site`` there."""
    folder = tmp_path_factory.mktemp("plugin")
    register(HERE, folder / "site")
    return folder


def environment(place: Path) -> dict[str, str]:
    path = os.pathsep.join(str(entry) for entry in (place / "site", HERE / "src", SOURCE))
    return {**os.environ, "PYTHONPATH": path, "COLUMNS": "200"}


def run(place: Path, *words: object) -> None:
    """Run a process that must end well."""
    done = subprocess.run(
        [sys.executable, *map(str, words)],
        capture_output=True,
        text=True,
        cwd=place,
        env=environment(place),
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def said(place: Path) -> dict[str, dict[str, Any]]:
    """The exit code and the standard output of each of `COMMANDS`."""
    (place / "test_theirs.py").write_text(CONTRACTS)
    run(place, "-c", SESSION, json.dumps(COMMANDS))
    return json.loads((place / "said.json").read_text())


@pytest.fixture(scope="module")
def trained(place: Path, said: dict[str, dict[str, Any]]) -> Path:
    """A run of their model, on demonstrations of their task."""
    assert said["train"]["code"] == 0
    return place / "mine"


def test_the_commands_offer_them(said: dict[str, dict[str, Any]]) -> None:
    names = {
        "train": ["straight", "two_buttons"],
        "drive": ["counting", "nearness", "two_buttons"],
        "teleop": ["counting"],
    }
    for command, offered in names.items():
        assert said[f"{command} help"]["code"] == 0
        for name in offered:
            assert f",{name}" in said[f"{command} help"]["out"]


def test_they_pass_the_tests_that_ours_pass(said: dict[str, dict[str, Any]]) -> None:
    assert said["contracts"]["code"] == 0, said["contracts"]["out"]
    assert " passed" in said["contracts"]["out"]


def test_their_model_is_saved_loaded_and_measured(trained: Path, said: dict[str, dict[str, Any]]) -> None:
    config = json.loads((trained / "config.json").read_text())
    assert (config["kind"], config["task"]) == ("straight", "two_buttons")
    assert said["evaluate"]["code"] == 0
    assert {row["model"] for row in json.loads(said["evaluate"]["out"])} == {"straight"}


def test_everything_of_theirs_drives_together(place: Path, said: dict[str, dict[str, Any]]) -> None:
    assert said["drive"]["code"] in (0, 1)  # 1: not reached
    about = json.loads((place / "driven" / "drives.json").read_text())["about"]
    assert about["arm"] == "counting"
    assert about["belief"] == "nearness"
    assert about["task"] == "two_buttons"


@pytest.mark.slow
def test_their_model_is_compared_with_ours(place: Path, trained: Path) -> None:
    asked = ("--demonstrations", "buttons", "--models", "straight", "scl", "--ours", "scl")
    run(place, "-m", "latentarm", "compare", *asked, "--preset", "smoke", "--jobs", 1, "--out", "compared")
    rows = json.loads((place / "compared" / "results.json").read_text())["rows"]
    assert {"straight", "scl"} <= {row["model"] for row in rows}


@contextmanager
def page(place: Path, *words: object) -> Iterator[str]:
    """A server, and its address."""
    command = [sys.executable, "-m", "latentarm", "teleop", *map(str, words), "--port", "0", "--json"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, cwd=place, env=environment(place)
    ) as server:
        try:
            assert server.stdout is not None
            yield json.loads(server.stdout.readline())["address"].rstrip("/")
        finally:
            server.send_signal(signal.SIGINT)
            server.communicate(timeout=30)


@pytest.mark.slow
def test_their_model_is_on_the_page_and_drives_their_arm_there(place: Path, trained: Path) -> None:
    with page(place, trained, "--arm", "counting") as address:
        with urllib.request.urlopen(f"{address}/teach", timeout=30) as answer:  # noqa: S310 - our own server
            html = answer.read().decode()
        assert 'value="straight"' in html
        with connect(address.replace("http", "ws") + "/drive", origin=address, compression=None) as socket:
            socket.send(json.dumps({"type": "hello", "version": 1, "name": "Ada"}))
            first = driven(socket, lambda state: state["phase"] == "ready", [0.0, 0.0], enable=True)
            socket.send(json.dumps({"type": "record", "on": True}))
            driven(socket, lambda state: distance(state, first) > 0.02, [1.0, 0.0])
            driven(socket, lambda state: state["phase"] == "ready", [0.0, 0.0])
            socket.send(json.dumps({"type": "record", "on": False}))
            time.sleep(0.5)
    (journal,) = (place / "teleop").glob("*.sqlite")
    run(place, "-m", "latentarm", "export", journal, "--out", "recorded")
    counts = read_dataset(place / "recorded").episodes[0].state / 1e-5
    assert np.ptp(counts, axis=0).max() > 100
    # Their encoders say whole numbers; the file has single precision.
    np.testing.assert_allclose(counts, np.round(counts), atol=0.1)


def distance(state, other):
    """How far the tool has moved, m."""
    return np.linalg.norm(np.subtract(state["tool"], other["tool"]))


def driven(socket, until, u, *, enable=False):
    """The first state of which something holds, with this input all the while."""
    sequence, asked_s, end_s = int(1000 * time.monotonic()), 0.0, time.monotonic() + 60.0
    while time.monotonic() < end_s:
        state = json.loads(socket.recv(timeout=60))
        if state["type"] != "state":
            continue
        if until(state):
            return state
        sequence += 1
        socket.send(
            json.dumps(
                {
                    "type": "input",
                    "seq": sequence,
                    "nonce": state["nonce"],
                    "u": u,
                    "source": "pointer",
                    "latched": False,
                }
            )
        )
        if enable and time.monotonic() - asked_s > 0.5:
            asked_s = time.monotonic()
            socket.send(json.dumps({"type": "enable"}))
    raise AssertionError(f"it never came to that: {state}")
