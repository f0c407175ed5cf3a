"""How fast the arm stops when something happens to the browser, the network or the server; see the script."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import find_chromium

SCRIPT = Path(__file__).parents[3] / "scripts" / "teleop_browser_faults.py"
ZERO_WITHIN_MS = 150
REST_WITHIN_MS = 400
TRIES = 3


@pytest.mark.parametrize(
    "fault",
    [
        "pointer released outside the window",
        "tab hidden",
        "page closed",
        "network cut",
        "server blocked for 300 ms",
        "browser killed",
    ],
)
def test_the_arm_stops_in_time(trained, tmp_path, fault):
    find_chromium()
    out = tmp_path / "times.json"
    command = [sys.executable, SCRIPT, trained, "--tries", str(TRIES), "--faults", fault, "--out", out]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert out.exists(), done.stderr
    measured = json.loads(out.read_text())[fault]
    assert measured["zero"]["n"] == TRIES
    assert measured["zero"]["worst_ms"] <= ZERO_WITHIN_MS
    assert measured["rest"]["worst_ms"] <= REST_WITHIN_MS
