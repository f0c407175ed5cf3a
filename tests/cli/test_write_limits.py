"""`latentarm robots FILE --write-limits`: a file with what is known, and room for what is not."""

import re

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import read_limits
from latentarm.robots.limits_template import limits_template
from latentarm.robots.notices import assumed_limits

URDF = """<robot name="two"><link name="base"/><link name="a"/><link name="b"/>
<joint name="shoulder pan" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="2" velocity="1.5" effort="1"/></joint>
<joint name="lift" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.4" velocity="0" effort="1"/></joint></robot>"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "two.urdf"
    path.write_text(URDF)
    return path


def test_what_is_known_is_stated_and_what_is_not_is_asked_for(model, tmp_path, capsys):
    out = tmp_path / "limits.toml"
    assert main(["robots", str(model), "--write-limits", str(out)]) == 0
    assert "Fill in: velocity of joint lift; acceleration and jerk of all joints" in capsys.readouterr().out
    robot = load_robot(model)
    again = load_robot(model, limits=read_limits(out))
    assert assumed_limits(again) == assumed_limits(robot)
    for figure in ("lower", "upper", "velocity"):
        np.testing.assert_array_equal(getattr(again.limits, figure), getattr(robot.limits, figure))
    # As a person fills it in.
    out.write_text(re.sub(r"^# (\w+) = .*", r"\1 = 3.0", out.read_text(), flags=re.MULTILINE))
    filled = load_robot(model, limits=read_limits(out))
    assert assumed_limits(filled) == ""
    assert filled.limits.jerk.tolist() == [3.0, 3.0]
    assert filled.limits.velocity.tolist() == [1.5, 3.0]


def test_nothing_is_left_to_fill_in_of_a_robot_that_is_known(tmp_path):
    text = limits_template(load_robot("panda"))
    assert "assumed" not in text
    path = tmp_path / "panda.toml"
    path.write_text(text)
    assert load_robot("panda", limits=read_limits(path)).limits.sources["jerk"] == ("limits_file",) * 7


@pytest.mark.parametrize(("name", "said"), [("limits.toml", "is there already"), ("limits.txt", "TOML")])
def test_no_file_is_overwritten(model, tmp_path, capsys, name, said):
    (tmp_path / "limits.toml").write_text("tool_speed_m_per_s = 1.0\n")
    assert main(["robots", str(model), "--write-limits", str(tmp_path / name)]) == 2
    assert said in capsys.readouterr().err
    assert (tmp_path / "limits.toml").read_text() == "tool_speed_m_per_s = 1.0\n"
    assert main(["robots", "--write-limits", str(tmp_path / "other.toml")]) == 2
