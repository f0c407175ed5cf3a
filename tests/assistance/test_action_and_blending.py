import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.action import assistive_action
from latentarm.assistance.blending import FixedAlpha, blend
from latentarm.errors import UserError

GOALS = np.array([[1.0, 0.0, 0.5], [-1.0, 2.0, 0.0]])
states = hnp.arrays(float, 3, elements=st.floats(-3, 3))


@given(states)
def test_a_certain_belief_leads_straight_to_its_goal(state):
    action = assistive_action(state, np.array([0.0, 1.0]), GOALS)
    assert state + action == pytest.approx(GOALS[1])


@given(states, st.floats(0, 1), st.floats(0.1, 5))
def test_assistance_is_the_sum_of_equation_3(state, certainty, gain):
    belief = np.array([certainty, 1 - certainty])
    wanted = gain * sum(b * (goal - state) for b, goal in zip(belief, GOALS, strict=True))
    assert assistive_action(state, belief, GOALS, gain) == pytest.approx(wanted)


def test_a_batch_of_states_is_helped_as_each_alone():
    rng = np.random.default_rng(1)
    state, belief = rng.normal(size=(4, 3)), rng.dirichlet([1, 1], size=4)
    each = [assistive_action(s, b, GOALS) for s, b in zip(state, belief, strict=True)]
    assert assistive_action(state, belief, GOALS) == pytest.approx(np.stack(each))


@given(states, states)
def test_blending_runs_from_the_person_to_the_robot(human, robot):
    assert np.array_equal(blend(human, robot, 0.0), human)
    assert np.array_equal(blend(human, robot, 1.0), robot)
    assert blend(human, robot, 0.5) == pytest.approx((human + robot) / 2)


def test_help_ends_when_the_person_lets_go():
    belief = np.array([0.5, 0.5])
    alpha = [FixedAlpha(0.6, full_at=0.5).alpha(np.array([0.0, u]), belief) for u in (0.0, 0.25, 0.5, 1.0)]
    assert alpha == pytest.approx([0.0, 0.3, 0.6, 0.6])


@given(hnp.arrays(float, 2, elements=st.floats()), st.floats(0, 1))
def test_alpha_is_a_share_for_any_input(u, value):
    with np.errstate(all="ignore"):
        assert 0.0 <= FixedAlpha(value).alpha(u, np.ones(1)) <= value


@pytest.mark.parametrize("wrong", [{"value": 1.1}, {"value": float("nan")}, {"full_at": 0.0}])
def test_an_alpha_that_is_no_share_is_refused(wrong):
    with pytest.raises(UserError):
        FixedAlpha(**wrong)
