import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.blending import assistive_action, blend

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


def test_a_batch_is_blended_as_each_alone(rng):
    human, robot, alpha = rng.normal(size=(4, 5, 3)), rng.normal(size=(4, 5, 3)), rng.uniform(size=(4, 5))
    together = blend(human, robot, alpha)
    for index in np.ndindex(4, 5):
        assert np.array_equal(together[index], blend(human[index], robot[index], float(alpha[index])))
