"""The contract of real arms, over an arm that answers over TCP."""

from dataclasses import replace

import pytest
from wooden_arm import WoodenArm
from wooden_server import wooden_server

from latentarm.arms.address import parse_address
from latentarm.arms.checking import look_at
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

    @pytest.mark.parametrize(
        ("stated", "why"),
        [
            ({"input_budget_s": 0.6}, "input_budget_s of 0.2 s at most"),
            ({"simulated": True, "input_budget_s": 0.6}, "must state simulated=False"),
        ],
    )
    def test_it_is_not_driven_from_far_away_whatever_its_driver_says(self, new_arm, robot, stated, why):
        assert look_at(new_arm, robot, 0.01).refusals == ()
        new_arm._spec = replace(new_arm.spec, **stated)
        [refusal] = look_at(new_arm, robot, 0.01).refusals
        assert why in refusal
