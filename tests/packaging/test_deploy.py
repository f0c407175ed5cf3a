"""The files in deploy/ name options, paths and versions that exist."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

from latentarm.cli import main

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"


def test_the_options_of_the_container_are_those_of_teleop(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["teleop", "--config", str(DEPLOY / "teleop.yaml")]) == 2
    assert "/home/latentarm/data/run" in capsys.readouterr().err  # all that is wrong: no run is there


def test_what_compose_mounts_and_builds_is_there() -> None:
    services = yaml.safe_load((DEPLOY / "compose.yaml").read_text())["services"]
    build = services["latentarm"]["build"]
    assert (DEPLOY / build["context"] / build["dockerfile"]).is_file()
    mounted = [one.split(":")[0] for service in services.values() for one in service["volumes"]]
    files = [one for one in mounted if one.startswith("./") and one != "./data"]
    assert files
    assert all((DEPLOY / one).is_file() for one in files)


def test_the_container_s_python_is_one_that_the_package_takes() -> None:
    version = re.search(r"FROM \S+/python:(\d+\.\d+)", (DEPLOY / "Containerfile").read_text())
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    assert version is not None
    assert [*map(int, version[1].split("."))] >= [*map(int, wanted.removeprefix(">=").split("."))]


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="This machine has no systemd.")
def test_systemd_understands_the_unit(tmp_path: Path) -> None:
    unit = (DEPLOY / "latentarm@.service").read_text().replace("/opt/latentarm/bin/latentarm", "/bin/true")
    (tmp_path / "latentarm@.service").write_text(unit)
    command = ["systemd-analyze", "verify", str(tmp_path / "latentarm@.service")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
