"""The contract of real arms, over an arm that answers over TCP."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from wooden_arm import WoodenArm
from wooden_server import wooden_server

from latentarm.arms.address import parse_address
from latentarm.arms.checking import look_at
from latentarm.control.clock import MonotonicClock, SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command
from latentarm.testing.real_arms import RealArmContract

EXAMPLE = Path(__file__).parents[1] / "plugins" / "latentarm_example" / "src"


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


def test_the_driver_in_the_docs_is_a_real_arm(the_panda, monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLE))
    from latentarm_example.driver import ExampleArm

    clock = SimulatedClock()
    old, arm = (
        ExampleArm(the_panda, parse_address(f"example://here?firmware={firmware}"), clock.now_s)
        for firmware in ("1.9", "2.0")
    )
    (refusal,) = look_at(old, the_panda, 0.01).refusals
    with pytest.raises(UserError, match=refusal):
        old.connect()
    assert look_at(arm, the_panda, 0.01).refusals == ()
    command = Command(np.full(7, 0.1), duration_s=0.05)
    with arm:
        before = arm.read().q
        arm.send(command)
        clock.wait_until(0.2)
        np.testing.assert_array_equal(arm.read().q, before)
        arm.enable()
        arm.send(command)
        clock.wait_until(1.0)
        moved = np.abs(arm.read().q - before)
        assert (moved > 0.004).all()
        assert (moved <= 0.1 * (0.05 + arm.spec.stops_after_s)).all()
