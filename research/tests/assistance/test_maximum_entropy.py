import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm_research.assistance.maximum_entropy import MaximumEntropyBelief

GOALS = np.random.default_rng(0).normal(0.0, 1.0, (3, 7))
costs, reaches = st.floats(0.1, 50), st.floats(0.01, 2)


@given(costs, reaches)
def test_the_cost_to_go_is_what_the_way_costs(cost, near):
    """c per rad, within delta c d / delta: V is its sum along the straight way."""
    model = MaximumEntropyBelief(GOALS, cost_per_rad=cost, near_rad=near)
    way = np.linspace(0.0, 4.0, 4001)
    per_rad = cost * np.minimum(way / near, 1.0)
    summed = np.concatenate([[0.0], np.cumsum((per_rad[1:] + per_rad[:-1]) / 2 * np.diff(way))])
    np.testing.assert_allclose(model.cost_to_go(way), summed, rtol=1e-3, atol=1e-3 * cost)


def test_the_cost_to_go_by_hand():
    model = MaximumEntropyBelief(GOALS, cost_per_rad=6.0, near_rad=0.5)
    # 6 x 0.25² / (2 x 0.5), 6 x 0.5 / 2 where they meet, 6 x 2 - 6 x 0.5 / 2.
    assert model.cost_to_go(np.array([0.0, 0.25, 0.5, 2.0])) == pytest.approx([0.0, 0.375, 1.5, 10.5])


@given(hnp.arrays(float, 7, elements=st.floats(-2, 2)), hnp.arrays(float, (5, 7), elements=st.floats(-1, 1)))
def test_near_every_goal_it_is_the_boltzmann_rule(state, actions):
    cost, near = 8.0, 20.0
    model = MaximumEntropyBelief(GOALS, cost_per_rad=cost, near_rad=near, floor=0.0)
    boltzmann = BoltzmannBelief(GOALS, beta=cost / (2 * near), floor=0.0)
    expected = boltzmann.observe(boltzmann.initial(), state, actions)
    assert model.observe(model.initial(), state, actions) == pytest.approx(expected)


@given(hnp.arrays(float, (5, 7), elements=st.floats(-1, 1)), hnp.arrays(float, 7, elements=st.floats(-2, 2)))
def test_for_every_goal_the_choices_share_one_probability(actions, state):
    """V_g(s) is what makes exp(V - Q) a distribution over U."""
    model = MaximumEntropyBelief(GOALS)
    each = [model.log_likelihood(state, np.roll(actions, -first, axis=0)) for first in range(5)]
    assert np.exp(each).sum(axis=0) == pytest.approx(1.0)


@given(hnp.arrays(float, 2, elements=st.floats(-1, 1)), hnp.arrays(float, (2, 7), elements=st.floats(-1, 1)))
def test_the_rate_of_the_loop_does_not_matter(u, matrix):
    slow, fast = (MaximumEntropyBelief(GOALS, period_s=period, floor=0.0) for period in (0.1, 0.05))

    def action_of(inputs):
        return inputs @ matrix

    once = slow.update(slow.initial(), u, np.zeros(7), action_of)
    twice = fast.update(fast.update(fast.initial(), u, np.zeros(7), action_of), u, np.zeros(7), action_of)
    assert twice == pytest.approx(once)


def test_far_away_the_distance_does_not_matter():
    """The straight way to two goals ahead says the same of the near one and of the far one."""
    goals, actions = np.array([[2.0, 0.0], [8.0, 0.0]]), np.array([[0.4, 0.0], [-0.4, 0.0]])
    model = MaximumEntropyBelief(goals)
    assert model.observe(model.initial(), np.zeros(2), actions) == pytest.approx([0.5, 0.5])
