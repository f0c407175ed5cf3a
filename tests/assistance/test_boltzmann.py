import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.boltzmann import BoltzmannBelief

DOF, COUNT = 7, 3
GOALS = np.random.default_rng(0).normal(0.0, 1.0, (COUNT, DOF))

states = hnp.arrays(float, DOF, elements=st.floats(-3, 3))
inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))
maps = hnp.arrays(float, (2, DOF), elements=st.floats(-1, 1))


def linear(matrix):
    return lambda u: u @ matrix


@given(inputs, states, maps)
def test_the_rate_of_the_loop_does_not_matter(u, state, matrix):
    slow, fast = (BoltzmannBelief(GOALS, period_s=period, floor=0.0) for period in (0.1, 0.05))
    once = slow.update(slow.initial(), u, state, linear(matrix))
    twice = fast.update(fast.update(fast.initial(), u, state, linear(matrix)), u, state, linear(matrix))
    assert twice == pytest.approx(once)


def test_a_decision_worked_by_hand():
    """Two goals a rad to either side, and a person who could go to either at 0.5 rad/s."""
    model = BoltzmannBelief(np.array([[1.0], [-1.0]]), beta=1.0, horizon_s=0.5, period_s=0.5, floor=0.0)
    near, far = 0.75**2, 1.25**2
    right = np.exp(-near) / (np.exp(-near) + np.exp(-far))
    after = model.observe(model.initial(), np.zeros(1), np.array([[0.5], [-0.5]]))
    assert after == pytest.approx([right, 1 - right])


@given(st.integers(0, COUNT - 1), st.floats(0.0, 1.0), st.floats(0.05, 0.5))
def test_stabbing_at_a_goal_does_not_speak_against_it(goal, away, speed):
    # A direction in which no goal lies from any other: down onto the food, say.
    aside = np.linalg.svd(GOALS - GOALS.mean(axis=0))[2][-1]
    rest = np.linalg.svd(np.vstack([GOALS - GOALS.mean(axis=0), aside]))[2][-1]
    model = BoltzmannBelief(GOALS)
    before = model.initial()
    for sign in (1.0, -1.0):
        u = np.array([sign, 0.0])
        after = model.update(before, u, GOALS[goal] + away * aside, linear(speed * np.stack([aside, rest])))
        assert after[goal] >= before[goal] - 1e-9


def test_with_one_axis_a_decoder_that_bends_is_asked_at_six_levels():
    """Left and right both lead to the first goal, so pressing right says nothing against the second."""
    goals = np.array([[1.0, 0.0], [0.0, 1.0]])
    asked = []

    def bent(u):
        asked.append(u)
        return np.concatenate([0.3 * u * u, 0.3 * (1 - u * u)], axis=-1)

    model = BoltzmannBelief(goals)
    after = model.update(model.initial(), np.array([1.0]), np.zeros(2), bent)
    assert asked[0].shape == (7, 1)
    # Only a middle press would have led to the second goal, and the person passed it over.
    assert after[0] > after[1]
