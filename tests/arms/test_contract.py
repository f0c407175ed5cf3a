"""The one contract, over every arm of ours and over one that breaks when it is told to."""

import pytest

from latentarm.arms.catalogue import ARMS
from latentarm.arms.kinematic import KinematicArm
from latentarm.testing.arms import ArmContract
from latentarm.testing.faults import FaultyArm


class TestKinematicArm(ArmContract):
    @pytest.fixture
    def make(self):
        return ARMS["kinematic"]


class TestMujocoArm(ArmContract):
    tolerance_rad = 2e-3  # the servo follows a command as fast as a joint may accelerate
    settling_s = 0.3

    @pytest.fixture
    def make(self):
        return ARMS["mujoco"]


class TestFaultyArm(ArmContract):
    @pytest.fixture
    def make(self):
        return lambda robot, state, now_s: FaultyArm(KinematicArm(robot, state, now_s), now_s)


def test_every_arm_of_ours_is_tested():
    assert set(ARMS) == {"kinematic", "mujoco"}
