"""Arms are made by name; only those that can be driven safely are driven."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.arms.catalogue import (
    ARMS,
    DEFAULT_ARM,
    PHYSICAL_ARM,
    check_named,
    make_arm,
    make_simulated_arm,
)
from latentarm.arms.contract import INPUT_BUDGET_S, SIMULATED_INPUT_BUDGET_S, ArmSpec, arm_refusals, check_arm
from latentarm.arms.kinematic import KinematicArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command
from latentarm.testing.faults import FaultyArm


def now_s():
    return 0.0


@pytest.fixture
def registered(monkeypatch):
    def hardware(robot, state, now_s):
        arm = FaultyArm(KinematicArm(robot, state, now_s), now_s)
        arm.arm._spec = replace(arm.spec, simulated=False)
        return arm

    monkeypatch.setitem(ARMS._loaded, "hardware", hardware)
    monkeypatch.setitem(ARMS._loaded, "thing", lambda robot, state, now_s: object())
    monkeypatch.setattr(ARMS, "_own", {**ARMS._own, "hardware": ":", "thing": ":"})


def test_the_default_is_in_the_catalogue():
    assert DEFAULT_ARM in ARMS


def test_an_unknown_arm_is_refused(the_panda):
    with pytest.raises(UserError, match="--arm names the arm 'wooden', which is not one of kinematic"):
        make_arm("wooden", the_panda, the_panda.home, now_s)


def test_an_address_without_its_scheme_leads_to_the_list_of_addresses():
    with pytest.raises(UserError, match=r"--arm 10.0.0.2:30002 is no address.*`latentarm arms list`"):
        check_named("10.0.0.2:30002")


@pytest.mark.usefixtures("registered")
def test_what_is_made_must_be_an_arm(the_panda):
    with pytest.raises(UserError, match="--arm thing made object"):
        make_arm("thing", the_panda, the_panda.home, now_s)


@pytest.mark.usefixtures("registered")
def test_time_is_simulated_for_simulated_arms_only(the_panda):
    with pytest.raises(UserError, match="--arm hardware is a real arm"):
        make_simulated_arm("hardware", the_panda, the_panda.home, now_s)
    assert not make_arm("hardware", the_panda, the_panda.home, now_s).spec.simulated


@pytest.mark.parametrize(
    ("stops_after_s", "why"),
    [(None, "not known whether"), (float("nan"), "not known whether"), (0.5, "500 ms"), (-0.1, "-100 ms")],
)
def test_an_arm_must_say_when_it_stops_by_itself(the_panda, stops_after_s, why):
    with pytest.raises(UserError, match=f"{why}.*stops by itself"):
        check_arm(ArmSpec(the_panda.joint_names, 100.0, stops_after_s, simulated=True), the_panda)


@given(st.floats())
@pytest.mark.parametrize(("simulated", "most_s"), [(True, 0.6), (False, 0.2)])
def test_no_arm_takes_older_inputs_than_its_kind_may(the_panda, simulated, most_s, budget_s):
    assert {True: SIMULATED_INPUT_BUDGET_S, False: INPUT_BUDGET_S}[simulated] == most_s
    spec = ArmSpec(the_panda.joint_names, 100.0, 0.02, simulated, the_panda.gripper, input_budget_s=budget_s)
    refusals = arm_refusals(spec, the_panda)
    assert (not refusals) == (0.0 < budget_s <= most_s)
    assert all(f"an input_budget_s of {most_s} s at most" in one for one in refusals)


@pytest.mark.parametrize("name", [DEFAULT_ARM, PHYSICAL_ARM])
def test_simulated_arms_may_be_far_away_and_other_arms_as_far_as_ever(the_panda, name):
    budget_s = make_arm(name, the_panda, the_panda.home, now_s).spec.input_budget_s
    assert budget_s == SIMULATED_INPUT_BUDGET_S
    unstated = ArmSpec(the_panda.joint_names, 100.0, 0.02, simulated=False)
    assert unstated.input_budget_s == INPUT_BUDGET_S


def test_an_arm_must_have_the_robots_joints(the_panda):
    other = ArmSpec(("shoulder", "elbow"), 100.0, 0.02, simulated=True)
    with pytest.raises(UserError, match="joints shoulder, elbow, and panda has joint1"):
        check_arm(other, the_panda)


def test_a_simulated_arm_moves_as_its_clock_goes_on(the_panda):
    time_s = 5.0
    arm = make_arm("kinematic", the_panda, the_panda.home, lambda: time_s)
    velocity = np.full(7, 0.1)
    with arm:
        arm.enable()
        arm.send(Command(velocity, duration_s=0.05))
        time_s = 5.02
        reading = arm.read()
        np.testing.assert_allclose(reading.q - the_panda.home, 0.02 * velocity)
        np.testing.assert_array_equal(reading.dq, velocity)
        assert reading.time_s == time_s
        time_s = 6.0
        np.testing.assert_allclose(arm.read().q - the_panda.home, 0.05 * velocity)
        assert not arm.read().dq.any()
    assert arm.status().phase == "off"
    # A clock that goes back tells nothing, and the arm goes on when time does.
    with arm:
        arm.enable()
        arm.send(Command(velocity, duration_s=0.05))
        before, time_s = arm.read().q, 1.0
        np.testing.assert_array_equal(arm.read().q, before)
        time_s = 1.02
        np.testing.assert_allclose(arm.read().q - before, 0.02 * velocity)
