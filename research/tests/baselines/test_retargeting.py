"""Retargeting: the tool follows the stick, and joints give way before their limits."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.assistance.controllers.axis_modes import TWO_STICKS, AxisModes
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm_research.baselines import retargeting
from latentarm_research.baselines.retargeting import RetargetingController

PANDA = load_robot("panda")
CONTROLLER = RetargetingController(PANDA)
NO_BELIEF = np.zeros(0)
HOME = Context(PANDA.home, NO_BELIEF)

inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))


@settings(max_examples=20)
@given(inputs, st.integers(0, 2))
def test_away_from_limits_the_tool_nearly_follows_the_stick(u, mode):
    jacobian = PANDA.chain.jacobian(PANDA.home)
    exact = jacobian @ EndEffectorController(PANDA).action(u, HOME, mode)
    followed = jacobian @ CONTROLLER.action(u, HOME, mode)
    assert followed[:3] == pytest.approx(exact[:3], abs=0.005)
    assert followed[3:] == pytest.approx(exact[3:], abs=0.05)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("joint", range(7))
def test_a_joint_at_its_limit_goes_no_farther_and_comes_away_freely(joint, side, monkeypatch):
    limits, state = PANDA.limits, PANDA.home.copy()
    state[joint] = limits.upper[joint] if side > 0 else limits.lower[joint]
    context = Context(state, NO_BELIEF)
    for mode in range(3):
        for u in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
            for sign in (1.0, -1.0):
                with monkeypatch.context() as free:
                    free.setattr(retargeting, "LIMITS", 1e-9)
                    wanted = side * CONTROLLER.action(sign * u, context, mode)[joint]
                given_ = side * CONTROLLER.action(sign * u, context, mode)[joint]
                if wanted > 1e-9:
                    assert -1e-9 <= given_ < wanted
                    assert given_ < 0.3
                else:
                    assert given_ <= 1e-9


@settings(max_examples=20)
@given(inputs, hnp.arrays(float, 7, elements=st.floats(0, 1)), st.integers(0, 2))
def test_small_changes_of_the_stick_are_small_changes_of_the_motion(u, share, mode):
    limits = PANDA.limits
    context = Context(limits.lower + share * (limits.upper - limits.lower), NO_BELIEF)
    here, there = CONTROLLER.action(np.stack([u, u + 1e-6]), context, mode)
    assert np.abs(here - there).max() < 1e-3


def test_it_has_no_bound_of_speed():
    assert CONTROLLER.speed_bound(HOME, 0) is None


@pytest.mark.parametrize("wrong", [{"linear_speed": 0.0}, {"angular_speed": np.nan}])
def test_speeds_that_are_none_are_refused(wrong):
    with pytest.raises(UserError, match=next(iter(wrong))):
        RetargetingController(PANDA, **wrong)


class TestTwoSticks:
    CONTROLLER = EndEffectorController(PANDA, 0.2, 0.4, modes=TWO_STICKS)

    def test_the_first_mode_moves_and_the_second_turns(self):
        u = np.array([0.5, -1.0, 0.25])
        jacobian = PANDA.chain.jacobian(PANDA.home)
        rotation = PANDA.chain.forward(PANDA.home).rotation
        moved, turned = (jacobian @ self.CONTROLLER.action(u, HOME, mode) for mode in range(2))
        assert moved == pytest.approx([0.1, -0.2, 0.05, 0, 0, 0], abs=1e-10)
        assert turned == pytest.approx([0, 0, 0, *(rotation @ (0.4 * u))], abs=1e-10)

    @pytest.mark.parametrize(
        ("names", "axes"), [((), ()), (("x",), ((),)), (("x",), ((6,),)), (("x", "y"), ((0,), (1, 2)))]
    )
    def test_modes_that_cannot_be_are_refused(self, names, axes):
        with pytest.raises(UserError, match="axes"):
            AxisModes(names, axes)
