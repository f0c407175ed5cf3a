"""Arms that other people described can be driven from the command line."""

from importlib.resources import files
from pathlib import Path

import pytest

from latentarm.cli import main
from result_rows import rows_in

JACO = files("dm_control") / "third_party" / "kinova" / "jaco_arm.xml"
UR5E = files("airo_models") / "arms" / "ur5e" / "ur5e.urdf"


@pytest.mark.parametrize("model", [JACO, UR5E], ids=["jaco_mjcf", "ur5e_urdf"])
def test_drives(model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["drive", "--robot", str(model), "--drives", "1", "--json"]) == 0
    means = {row.measure: row.mean for row in rows_in(Path("drives/drives.json"))}
    assert means["success_rate"] == 1.0
