"""The one contract, over every belief; and what some of them do besides."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.belief import log_choice
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
    st.sampled_from(["boltzmann", "maximum_entropy"]),
    weights,
    hnp.arrays(float, st.integers(1, 4), elements=st.floats(-1, 1)),
    states,
    states,
)
def test_a_choice_between_equals_says_nothing(name, prior, u, state, action):
    model = BELIEFS[name](GOALS, prior=prior)
    belief = model.initial()
    after = model.update(belief, u, state, lambda inputs: np.tile(action, (*inputs.shape[:-1], 1)))
    assert after == pytest.approx(belief, abs=1e-12)


@given(
    st.sampled_from([("boltzmann", "beta"), ("distance", "beta"), ("maximum_entropy", "cost_per_rad")]),
    inputs,
    states,
    maps,
)
def test_no_rationality_learns_nothing(rationality, u, state, matrix):
    name, parameter = rationality
    blind = BELIEFS[name](GOALS, **{parameter: 0.0})
    assert blind.update(blind.initial(), u, state, linear(matrix)) == pytest.approx(1 / COUNT)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("boltzmann", {"beta": -1.0}),
        ("boltzmann", {"beta": float("nan")}),
        ("boltzmann", {"horizon_s": 0.0}),
        ("distance", {"beta": float("inf")}),
        ("maximum_entropy", {"cost_per_rad": -1.0}),
        ("maximum_entropy", {"near_rad": 0.0}),
        ("maximum_entropy", {"horizon_s": float("nan")}),
    ],
)
def test_a_rule_s_own_parameters_are_checked(name, wrong):
    with pytest.raises(UserError, match=next(iter(wrong))):
        BELIEFS[name](GOALS, **wrong)


def test_what_is_far_better_does_not_overflow():
    better = np.array([[0.0, 0.0], [2000.0, -2000.0]])
    np.testing.assert_allclose(log_choice(better), [-2000.0, 0.0])
