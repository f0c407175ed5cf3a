from dataclasses import replace

import numpy as np
import pytest

from latentarm.arms.contract import Arm, check_limits
from latentarm.arms.kinematic import KinematicArm
from latentarm.errors import UserError
from latentarm.robots.limits import LimitSources
from latentarm.robots.model_file import load_model_file
from latentarm.robots.notices import assumed_limits, notices
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar


class RealArm(Arm):
    """Stands in for a driver of hardware."""

    simulated = False

    def state(self):
        return np.zeros(7)

    def velocity(self):
        return np.zeros(7)

    def send(self, command):
        raise AssertionError("nothing may be sent")

    def stop(self):
        pass


def test_built_in_robots_assume_nothing(the_panda):
    for robot in (the_panda, planar()):
        assert robot.limits.assumed == {}
        assert notices(robot) == []
        check_limits(RealArm(), robot)


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
    with pytest.raises(
        UserError, match=r"is a real arm, and its acceleration and jerk of all joints.*--limits"
    ):
        check_limits(RealArm(), ur5e)
    check_limits(KinematicArm(ur5e, ur5e.home), ur5e)
    # One figure of one joint is enough.
    sources = LimitSources.same("manufacturer", 7)
    one = replace(sources, jerk=("assumed", *sources.jerk[1:]))
    doubtful = replace(the_panda, limits=replace(the_panda.limits, sources=one))
    with pytest.raises(UserError, match="its jerk of joint joint1 is not known"):
        check_limits(RealArm(), doubtful)
    with pytest.raises(UserError, match="its largest speed of the tool"):
        check_limits(RealArm(), replace(panda(), tool_speed_source="assumed"))


def test_a_model_without_shape_is_said(written):
    bare = """<mujoco><worldbody><body><joint name="j" axis="0 0 1" range="-90 90"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="tip" pos="1 0 0"/></body></worldbody>
    </mujoco>"""
    assert any("no shape" in sentence for sentence in notices(load_model_file(written(bare))))
