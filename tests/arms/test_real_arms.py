"""The contract of real arms, over an arm that answers over TCP."""

import pytest
from wooden_arm import WoodenArm
from wooden_server import wooden_server

from latentarm.arms.address import parse_address
from latentarm.control.clock import MonotonicClock
from latentarm.testing.real_arms import RealArmContract


class TestWoodenArm(RealArmContract):
    settling_s = 0.05

    @pytest.fixture(scope="class")
    @classmethod
    def stand_in(cls, the_panda):
        with wooden_server(the_panda) as server:
            yield server

    @pytest.fixture
    def make(self, stand_in, robot):
        return lambda: WoodenArm(robot, parse_address(stand_in.address), MonotonicClock().now_s)

    @pytest.fixture
    def refused(self, robot):
        with wooden_server(robot, firmware="1.9") as old:
            yield lambda: WoodenArm(robot, parse_address(old.address), MonotonicClock().now_s)

    @pytest.fixture
    def address(self, stand_in):
        return stand_in.address
