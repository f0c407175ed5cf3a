"""`latentarm arms`: what there is is listed, and a real arm is looked at without being moved."""

import json
import os
import re
import shutil

import numpy as np
import pytest
from wooden_server import wooden_server

from documentation import ROOT, blocks, lines_of, serve
from latentarm.cli import main
from latentarm.robots.panda import fr3, panda


@pytest.fixture(scope="module")
def server():
    with wooden_server(panda()) as server:
        yield server


@pytest.fixture(scope="module")
def fr3_server():
    with wooden_server(fr3()) as server:
        yield server


def test_simulated_arms_and_schemes_of_real_ones_are_listed(capsys):
    assert main(["arms", "list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {"kinematic", "mujoco"} <= set(listed["simulated"])
    assert "wooden" in listed["real"]
    assert main(["arms", "list"]) == 0
    table = capsys.readouterr().out
    assert "franka://HOST " in table
    assert "lerobot://TYPE?port=/dev/ttyACM0&id=NAME" in table


def test_an_arm_that_can_be_driven_is_described_and_does_not_move(server, capsys):
    before = server.positions()
    assert main(["arms", "check", server.address, "--robot", "panda"]) == 0
    told = capsys.readouterr().out
    assert "firmware" in told
    assert f"latentarm teleop --arm {server.address} --robot panda" in told
    np.testing.assert_array_equal(server.positions(), before)
    assert set(server.requests) == {"hello"}


def test_the_line_that_drives_the_arm_has_what_it_was_checked_with(server, capsys, tmp_path):
    limits = tmp_path / "slow limits.toml"
    limits.write_text("[joints.joint1]\nvelocity_rad_per_s = 0.7\n")
    words = ["arms", "check", server.address, "--robot", "panda", "--limits", str(limits)]
    assert main([*words, "--joint-speed", "0.2"]) == 0
    told = capsys.readouterr().out.replace("\n", " ")
    assert f"--arm {server.address} --robot panda --limits '{limits}' --joint-speed 0.2" in told


def test_everything_that_an_arm_is_refused_for_is_said_at_once(capsys):
    with wooden_server(panda(), firmware="1.9") as old:
        assert (
            main(["arms", "check", f"{old.address}?rate=30&stops_after=0.3", "--robot", "panda", "--json"])
            == 2
        )
    told = capsys.readouterr()
    refusals = json.loads(told.out)["refusals"]
    assert len(refusals) == 3
    assert all(sentence.endswith(".") and sentence in told.err for sentence in refusals)


def test_limits_beyond_those_of_the_arm_are_refused(server, capsys, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("[joints.joint1]\nvelocity_rad_per_s = 9.0\n")
    assert main(["arms", "check", server.address, "--robot", "panda", "--limits", str(limits)]) == 2
    assert (
        "The velocity limit of joint1 is 515.7°/s for panda and 124.6°/s for the arm"
        in capsys.readouterr().err
    )


def test_limits_that_the_arm_does_not_confirm_are_told_in_figures(server, capsys, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("[joints.joint1]\njerk_rad_per_s3 = 2000\nvelocity_rad_per_s = 1.5\n")
    words = ["arms", "check", server.address, "--robot", "panda", "--limits", str(limits)]
    words += ["--joint-speed", "0.2", "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    facts = {fact["name"]: fact["value"] for fact in found["facts"]}
    assert facts["velocity limits"].startswith("85.9, 124.6,")
    assert "; the arm's own: 124.6, 124.6," in facts["velocity limits"]
    assert facts["jerk limits"].startswith("2000.0, 3750.0,")
    assert "by the limits file and its maker's documents; the arm states none" in facts["jerk limits"]
    (notice,) = found["notices"]
    assert notice.startswith("The arm itself does not confirm the limits of acceleration, jerk")
    assert main(words[:-1]) == 0
    assert notice in capsys.readouterr().out


ZONES = """
[zones.face]
shape = "sphere"
centre_m = [2.0, 0.0, {tool_z}]
radius_m = 0.2
speed_m_per_s = 0.05

[keep_out.wall]
shape = "half_space"
point_m = [{wall_x}, 0.0, 0.0]
normal = [-1.0, 0.0, 0.0]
clearance_m = 0.08
"""


@pytest.mark.parametrize(("before_m", "said"), [(0.3, False), (0.05, True)])
def test_the_check_tells_how_far_zones_and_solids_are(server, capsys, tmp_path, before_m, said):
    robot = panda()
    q = server.positions()
    tool = robot.chain.forward(q).position
    zones = tmp_path / "zones.toml"
    zones.write_text(ZONES.format(tool_z=tool[2], wall_x=tool[0] + before_m))
    words = ["arms", "check", server.address, "--robot", "panda", "--zones", str(zones)]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    facts = {fact["name"]: fact["value"] for fact in found["facts"]}
    to_face, to_wall = (
        float(facts[name].split(" mm away from ")[0]) for name in ("zone face", "keep out of wall")
    )
    assert 1000 * (2.0 - tool[0] - 0.2) - 100 < to_face <= 1000 * (2.0 - tool[0] - 0.2) + 0.5
    assert 1000 * before_m - 100 < to_wall <= 1000 * before_m + 0.5
    assert any("80 mm are kept" in notice for notice in found["notices"]) == said
    assert main(words) == 0
    assert f"--zones {zones}" in capsys.readouterr().out.replace("\n", " ")


def test_zones_that_allow_too_much_are_refused_as_by_teleop(server, capsys, tmp_path):
    zones = tmp_path / "zones.toml"
    zones.write_text(ZONES.replace("0.05", "0.3").format(tool_z=0.5, wall_x=1.0))
    for words in (["arms", "check", server.address], ["teleop", "--arm", server.address]):
        assert main([*words, "--robot", "panda", "--zones", str(zones)]) == 2
        assert "the zone 'face' allows 0.3 m/s" in capsys.readouterr().err


@pytest.mark.parametrize("words", [("arms", "check", "mujoco"), ("drive", "--arm", "wooden://127.0.0.1:1")])
def test_real_and_simulated_arms_are_told_apart(words, capsys):
    assert main(list(words)) == 2
    assert "real arm" in capsys.readouterr().err


def test_an_address_without_a_driver_leads_to_the_list_of_addresses(capsys):
    assert main(["arms", "check", "172.16.0.2", "--robot", "fr3"]) == 2
    assert "`latentarm arms list`" in capsys.readouterr().err


def test_no_robot_is_taken_for_an_arm_that_nobody_named(server, capsys, tmp_path):
    for words in (
        ["arms", "check", server.address],
        ["teleop", "--arm", server.address, "--out", str(tmp_path)],
    ):
        assert main(words) == 2
        assert "add --robot NAME_OR_FILE" in capsys.readouterr().err


def test_where_there_is_no_arm_it_says_so(capsys):
    assert main(["arms", "check", "wooden://127.0.0.1:1", "--robot", "panda"]) == 2
    assert "There is no wooden arm at 127.0.0.1:1." in capsys.readouterr().err


PAGE = ROOT / "docs" / "your-arm.md"
LINES = [line for block in blocks(PAGE) if block.language == "text" for line in lines_of(block)]


@pytest.fixture
def as_tried(server, fr3_server, trained):
    """A line of the page with the arm that it names and a run that exists."""

    def tried(line):
        address = (fr3_server if "--robot fr3" in line else server).address
        return line.replace("franka://172.16.0.2", address).replace("runs/mine", str(trained))

    return tried


@pytest.mark.parametrize("line", [line for line in LINES if line.startswith("latentarm arms check")])
def test_the_commands_of_the_page_about_your_arm_run(line, as_tried, workplace):
    (workplace / "limits.toml").write_text("[joints.joint1]\nvelocity_rad_per_s = 0.7\n")
    assert main(as_tried(line).split()[1:]) == 0


def teleop_lines():
    """The lines with a run, and one with all the options of those without."""
    lines = [line for line in LINES if line.startswith("latentarm teleop")]
    runless = [line for line in lines if line.startswith("latentarm teleop --")]
    options = dict.fromkeys(option for line in runless for option in re.findall(r"--\S+ \S+", line))
    return [*(line for line in lines if line not in runless), f"latentarm teleop {' '.join(options)}"]


@pytest.mark.parametrize("line", teleop_lines())
def test_the_page_is_served_as_the_page_about_your_arm_says(line, as_tried, workplace, monkeypatch):
    shutil.copy(PAGE.parent / "your-arm" / "zones.toml", workplace)
    stand_ins = ROOT / "tests" / "stand_ins"
    monkeypatch.setenv("PYTHONPATH", f"{stand_ins}:{os.environ.get('PYTHONPATH', '')}")
    serve(as_tried(line))
