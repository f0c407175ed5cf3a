import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm_research.people.boltzmann import boltzmann

COSTS = arrays(np.float64, st.tuples(st.integers(1, 4), st.integers(1, 6)), elements=st.floats(0, 1e3))
ANY_COSTS = arrays(np.float64, st.tuples(st.integers(1, 4), st.integers(1, 6)), elements=st.floats())
BETA = st.floats(0, 1e6) | st.just(np.inf)


@given(ANY_COSTS, st.floats(0) | st.just(np.inf))
def test_probabilities_whatever_the_costs(cost, beta):
    probability = boltzmann(cost, beta)
    assert probability.shape == cost.shape
    assert (probability >= 0).all()
    assert probability.sum(axis=-1) == pytest.approx(1.0)
    some = np.isfinite(cost).any(axis=-1)
    assert not probability[some][~np.isfinite(cost[some])].any()
    assert (probability[~some, 0] == 1).all()


@given(COSTS, BETA)
def test_what_every_option_costs_alike_changes_nothing(cost, beta):
    whole = np.round(cost)  # so that nothing is lost by adding
    np.testing.assert_array_equal(boltzmann(whole + 8.0, beta), boltzmann(whole, beta))


@given(COSTS, st.floats(0, 10))
def test_equation_24(cost, beta):
    weight = np.exp(-beta * (cost - cost.min(axis=-1, keepdims=True)))
    assert boltzmann(cost, beta) == pytest.approx(weight / weight.sum(axis=-1, keepdims=True))


@given(COSTS)
def test_without_reason_all_alike_and_with_endless_reason_the_cheapest(cost):
    assert boltzmann(cost, 0.0) == pytest.approx(1 / cost.shape[-1])
    cheapest = cost == cost.min(axis=-1, keepdims=True)
    assert boltzmann(cost, np.inf) == pytest.approx(cheapest / cheapest.sum(axis=-1, keepdims=True))


@given(st.integers(1, 5), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_many_people_at_once_are_each_by_themselves(rows, options, seed):
    rng = np.random.default_rng(seed)
    cost = rng.uniform(0, 1, (rows, options))
    cost[rng.uniform(size=cost.shape) < 0.2] = np.nan
    beta = rng.choice([0.0, 3.0, 1e4, np.inf], rows)
    together = boltzmann(cost, beta)
    for row in range(rows):
        np.testing.assert_array_equal(together[row], boltzmann(cost[row], float(beta[row])))
    # One set of options for people of several minds.
    assert boltzmann(cost[0], beta).shape == (rows, options)
