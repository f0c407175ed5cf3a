"""An interpreter with LeRobot 0.6, which wants a newer Python and an older torch than our own."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def lerobot_python() -> str:
    """The interpreter; skips the test where there is none."""
    given = os.environ.get("LATENTARM_LEROBOT_06_PYTHON")
    python = Path(given) if given else ROOT / ".venv-lerobot-06/bin/python"
    if not python.exists():
        pytest.skip("no environment with LeRobot 0.6: `make lerobot` builds one (Python 3.12, several GB)")
    return str(python)


def plugin_environment(folder: Path) -> dict[str, str]:
    """Variables with which that interpreter finds this source and the plug-in, whose wheel is built here.

    Args:
        folder: an empty folder.
    """
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT / "plugins/lerobot_robot_latentarm", check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "plugin")
    paths = os.pathsep.join([str(folder / "plugin"), str(ROOT / "src")])
    offline = {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1", "HF_HOME": str(folder / "home")}
    return os.environ | offline | {"PYTHONPATH": paths}
