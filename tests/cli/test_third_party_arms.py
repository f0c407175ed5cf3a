"""Arms that other people described can be driven from the command line."""

import csv
from importlib.resources import files
from pathlib import Path

import pytest

from latentarm.cli import main

JACO = files("dm_control") / "third_party" / "kinova" / "jaco_arm.xml"
UR5E = files("airo_models") / "arms" / "ur5e" / "ur5e.urdf"


@pytest.mark.parametrize("model", [JACO, UR5E], ids=["jaco_mjcf", "ur5e_urdf"])
def test_drives(model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["drive", "--robot", str(model), "--drives", "1", "--time-limit-s", "8", "--json"]) == 0
    with Path("drives/drives.csv").open(encoding="utf-8") as file:
        endings = {row["ended_because"] for row in csv.DictReader(file)}
    # One who looks one step ahead may stretch the UR5e's elbow straight, where no single input leads on.
    assert "done" in endings
    assert endings <= {"done", "time_limit"}
