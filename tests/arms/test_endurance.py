"""The scripts that break everything about an arm many times, each thing once here: they run to their end."""

import json
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"
CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
ONCE = ("--minutes", "0.05", "--tries", "1")

pytestmark = [pytest.mark.slow, pytest.mark.clock]


def needs(*modules: str) -> pytest.MarkDecorator:
    missing = [name for name in modules if find_spec(name) is None]
    return pytest.mark.skipif(bool(missing), reason=f"not installed: {', '.join(missing)}")


def run(script: str, *words: str) -> str:
    done = subprocess.run(
        [sys.executable, str(SCRIPTS / script), *ONCE, *words], capture_output=True, text=True, timeout=300.0
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs("xarm")
def test_of_the_xarm(tmp_path):
    run("xarm_endurance.py", "--json", str(tmp_path / "found.json"))
    tries = json.loads((tmp_path / "found.json").read_text())["tries"]
    assert len(tries) == 5
    assert all(len(found) == 1 and found[0]["jump_mm"] < 0.5 for found in tries.values())


@needs("roslibpy")
def test_of_the_arm_behind_ros_2(tmp_path):
    run("ros2_endurance.py", "--out", str(tmp_path))
    found = json.loads((tmp_path / "endurance.json").read_text())
    assert all(tries[0]["crept_mm"] < 0.5 for tries in found["faults"].values())
    assert [moved for _, _, moved in found["refusals"]] == [0.0] * 8


@needs("franky", "franky_sim")
def test_of_the_franka():
    ran, *faults = map(json.loads, run("franka_endurance.py").splitlines())
    assert ran["ticks"] > 100
    assert len(faults) == 5
    assert all(one["jump_mm_max"] < 0.5 and one["moved_before_enabling"] == 0 for one in faults)


@pytest.mark.browser
@pytest.mark.skipif(not any(map(shutil.which, CHROMIUM)), reason="no Chromium is installed")
@pytest.mark.parametrize(
    "arm",
    [
        pytest.param("franka", marks=needs("franky", "franky_sim", "playwright")),
        pytest.param("ros2", marks=needs("roslibpy", "playwright")),
        pytest.param("xarm", marks=needs("xarm", "playwright")),
    ],
)
def test_of_the_page(arm):
    found = json.loads(run("arm_page.py", "--arm", arm))
    assert found["driving"]["enabled_s"] > 0.0
    closed = found["page closed"]
    assert closed["moves_when_enabled"] == 1
    assert closed["rest_ms_max"] < 400.0
