"""Every reader meets files that were made for it: one sentence, exit code 2, nothing left, nothing run."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="makes named pipes and forks")

SWEEP = Path(__file__).with_name("hostile.py")


def sweep(*words: str) -> str:
    """Run the sweep in a process of its own, from which it can fork; its table."""
    done = subprocess.run([sys.executable, SWEEP, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_some_hostile_files() -> None:
    assert "| HDF5 | 1 | 1 |" in sweep("1", "CSV", "npz", "HDF5", "MJCF", "URDF", "journal")


@pytest.mark.slow
def test_three_hundred_hostile_files() -> None:
    lines = sweep().splitlines()[2:]
    assert sum(int(line.split("|")[2]) for line in lines) == 300
