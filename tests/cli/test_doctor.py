"""`latentarm doctor` finds what is wrong with a computer, says what to do, and commands no arm."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from wooden_server import wooden_server

from latentarm import cli
from latentarm.commands import doctor
from latentarm.core.machine import examine_machine
from latentarm.robots.panda import panda
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.config import TeleopConfig, listen

WITH_A_LIMIT = """
import ctypes, os, resource, sys
ctypes.CDLL(None).prctl(24, 23, 0, 0, 0)  # not even root has CAP_SYS_NICE then
limit = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_RTPRIO, (limit, limit))
os.execv(sys.executable, [sys.executable, *sys.argv[2:]])
"""
ASK = """
from pathlib import Path
from latentarm.core.machine import examine_machine
print(next(examine_machine(Path("."), 0, 0.1)))
"""
BRIEFLY = """
import sys
from latentarm import cli
from latentarm.commands import doctor
doctor._MEASURED_S = 0.1
sys.exit(cli.main(sys.argv[1:]))
"""
TAKE = "import os; os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(10))"


@pytest.fixture(autouse=True)
def fixture_short(monkeypatch):
    """Pauses are measured as they are for people, but not for as long."""
    monkeypatch.setattr(doctor, "_MEASURED_S", 0.1)


def found(capsys, *options):
    """The exit code, and the findings by name."""
    code = cli.main(["doctor", "--port", "0", "--json", *options])
    return code, {one["name"]: one for one in json.loads(capsys.readouterr().out)}


@pytest.mark.skipif(sys.platform != "linux", reason="priorities are Linux's")
@pytest.mark.parametrize("limit", [0, 10])
def test_whether_real_time_priority_is_allowed(limit):
    words = [sys.executable, "-c", WITH_A_LIMIT, str(limit), "-c", ASK]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if "not allowed to raise" in done.stderr:  # then as it is here
        done = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True, check=False)
        limit = "limits.d" not in done.stdout
        assert subprocess.run([sys.executable, "-c", TAKE], check=False).returncode == (0 if limit else 1)
    assert f"real-time priority is {'allowed' if limit else 'refused'}" in done.stdout
    assert ("limits.d" in done.stdout) is not bool(limit)


def test_a_port_in_use_is_the_users_to_change_and_a_free_one_is_left_free(capsys, tmp_path):
    with listen(TeleopConfig(Spec(), port=0)) as taken:
        port = str(taken.getsockname()[1])
        code, said = found(capsys, "--out", str(tmp_path), "--port", port)
        assert code == 2
        assert said["port"]["level"] == "fault"
        assert "--port" in said["port"]["means"]
    code, said = found(capsys, "--out", str(tmp_path), "--port", port)
    assert code < 2
    assert said["port"]["level"] == "good"
    assert set(said) == {"priority", "cores", "load", "pauses", "clock", "disk", "GL", "port"}
    assert not list(tmp_path.iterdir())


def disk(folder, least=0):
    (finding,) = (one for one in examine_machine(folder, least, 0.01) if one.name == "disk")
    return finding


def test_little_room_is_a_warning_and_a_folder_need_not_be_there_yet(tmp_path):
    assert disk(tmp_path / "not" / "yet").level == "good"
    assert not (tmp_path / "not").exists()
    short = disk(tmp_path, 10**18)
    assert short.level == "warning"
    assert "--keep-free-gb" in short.means


@pytest.mark.parametrize("options", ["ro", "size=32k"])
def test_a_disk_that_is_full_or_cannot_be_written(tmp_path, options):
    mount = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(tmp_path)]
    try:
        done = subprocess.run(mount, capture_output=True, check=False)
    except FileNotFoundError:
        pytest.skip("there is no mount here")
    if done.returncode:
        pytest.skip("nothing can be mounted here")
    try:
        finding = disk(tmp_path / "teleop")
        assert finding.level == "fault"
        assert "cannot be written" in finding.found
        assert "--out" in finding.means
    finally:
        subprocess.run(["umount", str(tmp_path)], check=True)


def test_without_opengl_it_says_what_needs_it_and_an_unknown_one_is_named_first(tmp_path):
    words = [sys.executable, "-c", BRIEFLY, "doctor", "--port", "0", "--json", "--out", str(tmp_path)]
    said = {}
    for name in ("egl", "nonsense"):
        done = subprocess.run(
            words, capture_output=True, text=True, check=False, env={**os.environ, "MUJOCO_GL": name}
        )
        said[name] = done.returncode, {one["name"]: one for one in json.loads(done.stdout)}
    code, lines = said["nonsense"]
    assert code == 2
    assert lines["GL"]["level"] == "fault"
    assert "MUJOCO_GL: nonsense" in lines["GL"]["found"]
    code, lines = said["egl"]
    assert code < 2
    assert lines["GL"]["level"] == "good"
    assert "draws with" in lines["GL"]["found"] or "MUJOCO_GL" in lines["GL"]["means"]


def test_an_arm_is_asked_and_not_commanded(capsys, tmp_path):
    with wooden_server(panda()) as server:
        options = ("--out", str(tmp_path), "--arm", server.address, "--robot", "panda")
        code, said = found(capsys, *options)
        assert said["arm"]["level"] == "good"
        assert set(server.requests) <= {"hello", "read"}
        server.firmware = "1.0"
        code, said = found(capsys, *options)
        assert (code, said["arm"]["level"]) == (2, "fault")
        assert "too old: update it" in said["arm"]["means"]
    code, said = found(capsys, "--out", str(tmp_path), "--arm", "wooden://127.0.0.1:1", "--robot", "panda")
    assert (code, said["arm"]["level"]) == (2, "fault")
    assert "There is no wooden arm" in said["arm"]["means"]


def test_teleop_says_what_matters_before_it_drives_a_real_arm(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["--arm", "wooden://127.0.0.1:1", "--robot", "panda", "--keep-free-gb", "1000000"]
    assert cli.main(["teleop", *words, "--out", str(Path("t"))]) == 2
    assert "This computer: disk: " in capsys.readouterr().out
    assert cli.main(["teleop", "nowhere", "--keep-free-gb", "1000000"]) == 2
    assert "This computer" not in capsys.readouterr().out
