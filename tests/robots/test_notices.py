from dataclasses import replace

import pytest

from latentarm.arms.contract import ArmSpec, check_arm
from latentarm.core.errors import UserError
from latentarm.robots.limits import same_source
from latentarm.robots.model_file import load_model_file
from latentarm.robots.notices import assumed_limits, notices
from latentarm.robots.planar import planar


def real(robot):
    """What the driver of a real arm says of it."""
    return ArmSpec(
        robot.joint_names, rate_hz=100.0, stops_after_s=0.02, simulated=False, gripper=robot.gripper
    )


def test_built_in_robots_assume_nothing(the_panda):
    for robot in (the_panda, planar()):
        assert robot.limits.assumed == {}
        assert notices(robot) == []
        check_arm(real(robot), robot)


def test_which_limits_of_a_file_are_assumed_is_said(ur5e_file, jaco_file):
    ur5e = load_model_file(ur5e_file)
    assert assumed_limits(ur5e) == "acceleration and jerk of all joints; largest speed of the tool"
    jaco = load_model_file(jaco_file)
    assert "velocity, acceleration and jerk of all joints" in assumed_limits(jaco)
    assert [
        sentence for sentence in notices(ur5e) if "assumed" in sentence.lower() and "--limits" in sentence
    ]


def test_a_real_arm_refuses_limits_that_are_assumed(the_panda, ur5e_file):
    ur5e = load_model_file(ur5e_file)
    with pytest.raises(UserError, match=r"known limits alone.*acceleration and jerk of all joints.*--limits"):
        check_arm(real(ur5e), ur5e)
    check_arm(replace(real(ur5e), simulated=True), ur5e)
    # One figure of one joint is enough.
    sources = same_source("manufacturer", 7)
    one = {**sources, "jerk": ("assumed", *sources["jerk"][1:])}
    doubtful = replace(the_panda, limits=replace(the_panda.limits, sources=one))
    with pytest.raises(UserError, match=r"assumed in part \(jerk of joint joint1"):
        check_arm(real(doubtful), doubtful)
    with pytest.raises(UserError, match="largest speed of the tool"):
        check_arm(real(the_panda), replace(the_panda, tool_speed_source="assumed"))


def test_a_model_without_shape_is_said(written):
    bare = """<mujoco><worldbody><body><joint name="j" axis="0 0 1" range="-90 90"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="tip" pos="1 0 0"/></body></worldbody>
    </mujoco>"""
    assert any("no shape" in sentence for sentence in notices(load_model_file(written(bare))))
