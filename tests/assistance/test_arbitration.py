import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha, confidence
from latentarm.core.errors import UserError

FULL = np.array([1.0, 0.0])
arbitrations = st.one_of(
    st.builds(FixedAlpha, value=st.floats(0, 1), full_at=st.floats(0.01, 1)),
    st.builds(
        ConfidenceAlpha, most=st.floats(0, 1), unsure_below=st.floats(0, 0.5), sure_above=st.floats(0.51, 1)
    ),
)
weights = st.integers(1, 6).flatmap(lambda count: hnp.arrays(float, count, elements=st.floats(0.01, 1)))


def certainty(most, goals):
    """A belief (G,) that gives one goal ``most`` and the others the same."""
    belief = np.full(goals, (1 - most) / (goals - 1))
    belief[1] = most
    return belief


@given(arbitrations, hnp.arrays(float, 2, elements=st.floats()), weights)
def test_alpha_is_a_share_for_any_input(arbitration, u, weight):
    alpha = arbitration.alpha(u, weight / weight.sum())
    assert 0.0 <= float(alpha) <= 1.0
    if not np.isfinite(u).all():
        assert alpha == 0.0


@given(arbitrations, weights)
def test_an_arm_whose_person_lets_go_stands_still(arbitration, weight):
    assert not arbitration.acts_at_rest
    assert arbitration.alpha(np.zeros(2), weight / weight.sum()) == 0.0


@given(arbitrations, weights, st.lists(st.floats(0, 1), min_size=2, max_size=2))
def test_help_grows_with_the_input(arbitration, weight, sizes):
    less, more = (arbitration.alpha(size * FULL, weight / weight.sum()) for size in sorted(sizes))
    assert less <= more


@given(arbitrations, st.integers(2, 9), st.lists(st.floats(0, 1), min_size=2, max_size=2))
def test_help_never_shrinks_as_the_robot_gets_surer(arbitration, goals, shares):
    less, more = (
        arbitration.alpha(FULL, certainty(1 / goals + share * (1 - 1 / goals), goals))
        for share in sorted(shares)
    )
    assert less <= more + 1e-12


def test_help_ends_when_the_person_lets_go():
    alpha = FixedAlpha(0.6, full_at=0.5).alpha(
        np.array([[0.0, 0.0], [0.0, 0.25], [0.5, 0.0], [0.0, 1.0]]), np.array([0.5, 0.5])
    )
    assert alpha == pytest.approx([0.0, 0.3, 0.6, 0.6])


@given(st.integers(2, 50), st.floats(0, 1))
def test_confidence_runs_from_even_odds_to_certainty(goals, share):
    assert confidence(certainty(1 / goals + share * (1 - 1 / goals), goals)) == pytest.approx(share)


def test_with_one_goal_the_robot_is_sure():
    assert confidence(np.ones(1)) == 1.0
    assert ConfidenceAlpha(0.4).alpha(FULL, np.ones(1)) == pytest.approx(0.4)


def test_between_unsure_and_sure_help_grows_in_proportion():
    arbitration = ConfidenceAlpha(most=0.8, unsure_below=0.25, sure_above=0.75, full_at=0.5)
    beliefs = np.array([[0.5, 0.5], [0.625, 0.375], [0.75, 0.25], [0.875, 0.125], [1.0, 0.0]])
    assert arbitration.alpha(FULL, beliefs) == pytest.approx([0.0, 0.0, 0.4, 0.8, 0.8])
    assert arbitration.alpha(FULL / 4, beliefs[2]) == pytest.approx(0.2)


@given(arbitrations)
def test_many_at_once_are_as_each_alone(arbitration):
    rng = np.random.default_rng(0)
    u, belief = rng.uniform(-1, 1, (3, 4, 2)), rng.dirichlet(np.ones(3), size=(3, 4))
    together = arbitration.alpha(u, belief)
    assert together.shape == (3, 4)
    for index in np.ndindex(3, 4):
        assert together[index] == pytest.approx(float(arbitration.alpha(u[index], belief[index])))


@pytest.mark.parametrize(
    ("kind", "wrong"),
    [
        (FixedAlpha, {"value": 1.1}),
        (FixedAlpha, {"value": float("nan")}),
        (FixedAlpha, {"full_at": 0.0}),
        (ConfidenceAlpha, {"most": -0.1}),
        (ConfidenceAlpha, {"unsure_below": 0.8}),
        (ConfidenceAlpha, {"sure_above": 1.2}),
        (ConfidenceAlpha, {"sure_above": float("nan")}),
        (ConfidenceAlpha, {"full_at": 2.0}),
    ],
)
def test_an_alpha_that_is_no_share_is_refused(kind, wrong):
    with pytest.raises(UserError):
        kind(**wrong)
