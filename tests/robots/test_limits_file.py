import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from documentation import ROOT, blocks
from latentarm.commands.abilities import abilities
from latentarm.core.errors import UserError
from latentarm.core.types import StatedJointLimits, StatedLimits
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import limits_document, parse_limits, read_limits
from latentarm.robots.notices import assumed_limits
from latentarm.web.arm_process.speed_limits import Speeds

TOML = """
tool_speed_m_per_s = 0.8
[joints.joint1]
lower_deg = -90
upper_deg = 90
velocity_rad_per_s = 1.5
[joints.joint2]
acceleration_deg_per_s2 = 180.0
jerk_rad_per_s3 = 300
"""
YAML = """
tool_speed_m_per_s: 0.8
joints:
  joint1: {lower_deg: -90, upper_deg: 90, velocity_rad_per_s: 1.5}
  joint2: {acceleration_deg_per_s2: 180.0, jerk_rad_per_s3: 300}
"""


@pytest.mark.parametrize(("name", "text"), [("a.toml", TOML), ("a.yaml", YAML), ("a.yml", YAML)])
def test_what_is_stated_takes_the_place_of_what_is_known(written, name, text):
    robot = load_robot("panda", limits=read_limits(written(text, name)))
    limits = robot.limits
    assert limits.upper[0] == pytest.approx(math.pi / 2)
    assert (limits.velocity[0], limits.jerk[1], robot.tool_speed_limit) == (1.5, 300.0, 0.8)
    assert limits.acceleration[1] == pytest.approx(math.pi)
    assert limits.sources["velocity"][:2] == ("limits_file", "manufacturer")
    assert (
        limits.sources["position"][0] == limits.sources["jerk"][1] == robot.tool_speed_source == "limits_file"
    )


def test_home_stays_within_what_is_stated():
    stated = StatedLimits({"joint4": StatedJointLimits(position=(-2.0, -1.0), sliding=False)})
    robot = load_robot("panda", limits=stated)
    assert not robot.limits.violation(robot.home).any()


def test_limits_of_a_file_that_says_none_are_no_longer_assumed(ur5e_file):
    robot = load_robot(str(ur5e_file))
    joints = {
        name: StatedJointLimits(acceleration=8.0, jerk=400.0, sliding=False) for name in robot.joint_names
    }
    known = load_robot(str(ur5e_file), limits=StatedLimits(joints, tool_speed=1.0))
    assert known.limits.assumed == {}
    assert known.stated_limits is not None


def test_the_example_of_the_docs_is_all_that_a_ur_needs_to_be_driven(ur5e_file, written):
    text = next(one.code for one in blocks(ROOT / "docs" / "arms.md") if one.language == "toml")
    robot = load_robot(str(ur5e_file), limits=read_limits(written(text, "limits.toml")))
    assert assumed_limits(robot) == ""
    assert robot.gripper is not None
    assert not abilities(robot, Speeds())[1]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "states no limits"),
        ("joints = 3", "joints must be a table"),
        ("[joints.a]\nvelocity = 3", r"no key joints\.a\.velocity; use .*velocity_rad_per_s"),
        (
            "[joints.a]\nvelocity_rad_per_s = -3",
            r"joints\.a\.velocity_rad_per_s is -3; it must be above zero",
        ),
        ("[joints.a]\nvelocity_rad_per_s = nan", r"velocity_rad_per_s must be a finite number"),
        ("[joints.a]\nvelocity_rad_per_s = true", r"velocity_rad_per_s must be a finite number"),
        (
            "[joints.a]\nvelocity_rad_per_s = 'fast'",
            r"velocity_rad_per_s must be a finite number, not 'fast'",
        ),
        ("[joints.a]\nlower_rad = 1", "joints.a gives only one of lower and upper"),
        ("[joints.a]\nlower_rad = 1\nupper_rad = 1", "lower limit that is not below"),
        ("[joints.a]\nacceleration_rad_per_s2 = 800", "name it acceleration_deg_per_s2"),
        ("[joints.a]\njerk_rad_per_s3 = 90000", "name it jerk_deg_per_s3"),
        ("[joints.a]\nvelocity_rad_per_s = 179", "name it velocity_deg_per_s"),
        ("[joints.a]\nlower_rad = -360\nupper_rad = 360", "name it lower_deg"),
        (
            "[joints.a]\nvelocity_deg_per_s = 1800",
            r"joints\.a\.velocity_deg_per_s is 1800, and no joint of an arm has more than 1718\.87",
        ),
        ("[joints.a]\nacceleration_deg_per_s2 = 6000", "has more than 5729.58: if it is in rad"),
        ("[joints.a]\njerk_deg_per_s3 = 1.2e6", r"jerk_deg_per_s3 is 1200000\.0, and .* 1\.14592e\+06"),
        ("[joints.a]\nlower_deg = -3000\nupper_deg = 0", "lower_deg is -3000, and .* 2864.79"),
        ("[joints.a]\nvelocity_m_per_s = 250", "velocity_m_per_s is 250, and .* 30: give it in m"),
        ("[joints.a]\njerk_rad_per_s3 = 1\njerk_deg_per_s3 = 1", "jerk twice, in different units"),
        ("[joints.a]\nlower_m = 1\nupper_rad = 2", "mixes m with rad"),
        ("tool_speed_m_per_s = 0", "tool_speed_m_per_s is 0"),
        ("speed = 1", "no key speed; use joints, tool_speed_m_per_s"),
        ("[joints", "cannot be read"),
    ],
)
def test_a_bad_file_is_refused_with_the_key_named(written, text, sentence):
    path = written(text, "bad.toml")
    with pytest.raises(UserError, match=sentence) as raised:
        read_limits(path)
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.txt", TOML, "must be TOML or YAML"),
        ("a.yaml", "joints: &a {b: *a}", "alias"),
        ("a.yaml", "joints: [", "is not a limits file that can be read"),
        ("a.yaml", "!!python/object/apply:os.system ['true']", "could not determine a constructor"),
        ("a.yaml", "[" * 20_000, "too deeply"),
        ("a.toml", "a = " + "[" * 20_000, "cannot be read"),
        ("a.yaml", "joints: {1: 2}", "joints must be a table of names"),
        ("a.yaml", "x" * 300_000, "a.yaml"),
    ],
)
def test_a_hostile_file_is_refused(written, name, text, sentence):
    with pytest.raises(UserError, match=sentence):
        read_limits(written(text, name))


def test_joints_of_another_arm_and_of_another_kind_are_refused():
    with pytest.raises(UserError, match="names the joint 'elbow'; the arm's joints are joint1, "):
        load_robot("panda", limits=StatedLimits({"elbow": StatedJointLimits(velocity=1.0, sliding=False)}))
    with pytest.raises(UserError, match=r"joints\.joint1 must be in rad or deg: the joint turns"):
        load_robot("panda", limits=StatedLimits({"joint1": StatedJointLimits(velocity=1.0, sliding=True)}))


FIGURE = st.none() | st.floats(1e-3, 1e3)


@given(
    FIGURE,
    FIGURE,
    FIGURE,
    st.none() | st.tuples(st.floats(-6, -0.1), st.floats(0, 6)),
    st.booleans(),
    st.none() | st.floats(1e-3, 1.0),
)
def test_what_is_kept_in_a_dataset_is_what_was_stated(
    velocity, acceleration, jerk, position, sliding, margin
):
    said = any(figure is not None for figure in (velocity, acceleration, jerk, position, margin))
    joint = StatedJointLimits(position, velocity, acceleration, jerk, sliding if said else None, margin)
    stated = StatedLimits({"j": joint}, tool_speed=1.0)
    assert parse_limits(limits_document(stated), "here") == stated
