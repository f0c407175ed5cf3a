"""The one contract, over every belief; and what some of them do besides."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.belief import log_choice
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.catalogue import BELIEFS
from latentarm.core.errors import UserError
from latentarm.testing.beliefs import (
    COUNT,
    GOALS,
    BeliefContract,
    inputs,
    linear,
    maps,
    states,
    weights,
)


class TestEveryBelief(BeliefContract):
    @pytest.fixture(params=list(BELIEFS))
    def rule(self, request):
        return BELIEFS[request.param]


@given(
    weights,
    hnp.arrays(float, st.integers(1, 4), elements=st.floats(-1, 1)),
    states,
    states,
)
def test_a_choice_between_equals_says_nothing(prior, u, state, action):
    model = BoltzmannBelief(GOALS, prior=prior)
    belief = model.initial()
    after = model.update(belief, u, state, lambda inputs: np.tile(action, (*inputs.shape[:-1], 1)))
    assert after == pytest.approx(belief, abs=1e-12)


@given(inputs, states, maps)
def test_no_rationality_learns_nothing(u, state, matrix):
    blind = BoltzmannBelief(GOALS, beta=0.0)
    assert blind.update(blind.initial(), u, state, linear(matrix)) == pytest.approx(1 / COUNT)


@pytest.mark.parametrize("wrong", [{"beta": -1.0}, {"beta": float("nan")}, {"horizon_s": 0.0}])
def test_a_rule_s_own_parameters_are_checked(wrong):
    with pytest.raises(UserError, match=next(iter(wrong))):
        BoltzmannBelief(GOALS, **wrong)


def test_what_is_far_better_does_not_overflow():
    better = np.array([[0.0, 0.0], [2000.0, -2000.0]])
    np.testing.assert_allclose(log_choice(better), [-2000.0, 0.0])


@pytest.mark.parametrize("name", list(BELIEFS))
def test_goals_that_moved_are_believed_in_as_if_they_had_always_been_there(name):
    u, state, matrix = np.array([0.6, -0.3]), np.zeros(GOALS.shape[1]), np.eye(2, GOALS.shape[1])
    before = BELIEFS[name](GOALS)
    moved, made = before.over(GOALS[::-1] + 0.1), BELIEFS[name](GOALS[::-1] + 0.1)
    belief = moved.initial()
    assert moved.update(belief, u, state, linear(matrix)).tolist() == pytest.approx(
        made.update(belief, u, state, linear(matrix))
    )
    with pytest.raises(ValueError, match="goals of shape"):
        before.over(GOALS[:1])
    with pytest.raises(ValueError, match="goals of shape"):
        before.over(np.full_like(GOALS, np.nan))


@given(st.floats(0.5, 20.0), weights, states)
def test_evidence_fades_towards_the_prior_by_e_in_the_memory(memory_s, prior, state):
    blind = BELIEFS["boltzmann"](GOALS, beta=0.0, period_s=0.1, prior=prior, floor=1e-6, memory_s=memory_s)
    begins = belief = np.roll(blind.initial(), 1)
    for _ in range(10):
        belief = blind.update(belief, np.array([1.0, 0.0]), state, linear(np.eye(2, GOALS.shape[1])))

    def odds(one):
        return np.log(one[1:] / one[0]) - np.log(blind.initial()[1:] / blind.initial()[0])

    assert odds(belief) == pytest.approx(np.exp(-1.0 / memory_s) * odds(begins), abs=1e-3)


def test_with_a_memory_confidence_has_a_limit():
    """Bayes' rule alone ends at its floor; what fades comes to rest where as much comes in."""
    matrix, u, state = np.eye(2, GOALS.shape[1]), np.array([0.02, 0.0]), np.zeros(GOALS.shape[1])
    kept = {}
    for memory_s in (2.0, float("inf")):
        model = BELIEFS["boltzmann"](GOALS, period_s=0.1, floor=1e-9, memory_s=memory_s)
        belief = model.initial()
        for _ in range(3000):
            belief = model.update(belief, u, state, linear(matrix))
        kept[memory_s] = belief.max()
    assert kept[float("inf")] > 0.99
    assert kept[2.0] < 0.9


def test_a_memory_of_nothing_is_refused():
    with pytest.raises(UserError, match="memory_s"):
        BELIEFS["boltzmann"](GOALS, memory_s=0.0)
