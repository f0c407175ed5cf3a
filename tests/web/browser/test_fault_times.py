"""How fast the arm stops when something happens to the browser, the network or the server."""

import json
import subprocess
import sys

import pytest

from .conftest import find_chromium

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
        "server blocked for 1 s",
        "browser killed",
    ],
)
def test_the_arm_stops_in_time(trained, tmp_path, fault):
    find_chromium()
    words = ["--run", trained, "--tries", str(TRIES), "--faults", fault, "--out", tmp_path / "out", "--json"]
    command = [sys.executable, "-m", "latentarm", "measure", "page-stops", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.stdout, done.stderr
    rows = {row["measure"]: row for row in json.loads(done.stdout)}
    assert rows["rest_worst_ms"]["n"] == TRIES
    assert rows["zero_command_worst_ms"]["mean"] <= ZERO_WITHIN_MS
    assert rows["rest_worst_ms"]["mean"] <= REST_WITHIN_MS
    assert done.returncode == 0
