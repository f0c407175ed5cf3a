"""What every belief does, whatever its likelihood."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.assistance.catalogue import BELIEFS
from latentarm.errors import UserError

DOF, COUNT = 7, 3
GOALS = np.random.default_rng(0).normal(0.0, 1.0, (COUNT, DOF))

rules = st.sampled_from(list(BELIEFS.values()))
states = hnp.arrays(float, DOF, elements=st.floats(-3, 3))
inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))
weights = hnp.arrays(float, COUNT, elements=st.floats(0.01, 1))
maps = hnp.arrays(float, (2, DOF), elements=st.floats(-1, 1))
seeds = st.integers(0, 2**32 - 1)
anything = st.floats(allow_nan=True, allow_infinity=True)


def linear(matrix):
    return lambda u: u @ matrix


@given(rules, weights, inputs, states, maps)
def test_a_belief_stays_a_distribution_above_its_floor(rule, prior, u, state, matrix):
    model = rule(GOALS, floor=0.02, prior=prior)
    belief = model.initial()
    for _ in range(3):
        belief = model.update(belief, u, state, linear(matrix))
    assert belief.sum() == pytest.approx(1.0)
    assert (belief >= 0.02).all()


@settings(max_examples=5)
@given(rules, seeds, st.integers(1, 3), st.floats(0, 0.3))
def test_ten_thousand_steps_leave_it_sound(rule, seed, axes, floor):
    rng = np.random.default_rng(seed)
    model = rule(GOALS, floor=floor)
    people = 4
    belief = np.tile(model.initial(), (people, 1))
    inputs = rng.uniform(-1, 1, (10_000, people, axes))
    inputs[rng.random((10_000, people)) < 0.1] = 0.0
    inputs[rng.random((10_000, people)) < 0.1] = np.nan
    matrix, state = rng.normal(size=(axes, DOF)), rng.normal(size=(people, DOF))
    for u in inputs:
        belief = model.update(belief, u, state, linear(matrix))
        assert (belief >= floor).all()
        assert abs(belief.sum(axis=-1) - 1).max() < 1e-12


@given(rules, weights)
def test_it_begins_with_its_prior(rule, prior):
    model = rule(GOALS, prior=prior, floor=0.0)
    assert model.initial() == pytest.approx(prior / prior.sum())
    assert rule(GOALS).initial() == pytest.approx(1 / COUNT)


@given(rules, weights, inputs, states, maps)
def test_the_prior_is_carried_on(rule, prior, u, state, matrix):
    """Bayes' rule: odds before and after differ by what the input says, whatever they were."""
    plain, other = rule(GOALS, floor=0.0), rule(GOALS, prior=prior, floor=0.0)
    said = plain.update(plain.initial(), u, state, linear(matrix))
    after = other.update(other.initial(), u, state, linear(matrix))
    assert after == pytest.approx(prior * said / (prior * said).sum(), abs=1e-9)


@given(rules, weights, states, maps)
def test_an_input_of_zero_says_nothing(rule, prior, state, matrix):
    model = rule(GOALS, prior=prior)
    belief = model.initial()
    for axes in (1, 2, 3):
        drift = lambda u, axes=axes: u.sum(axis=-1, keepdims=True) + np.ones(DOF)  # noqa: E731
        assert np.array_equal(model.update(belief, np.zeros(axes), state, drift), belief)


@given(rules, weights, inputs, states, maps, st.permutations(range(COUNT)))
def test_naming_the_goals_in_another_order_changes_nothing_else(rule, prior, u, state, matrix, order):
    model, shuffled = rule(GOALS, prior=prior), rule(GOALS[order], prior=prior[order])
    after = model.update(model.initial(), u, state, linear(matrix))
    assert shuffled.update(shuffled.initial(), u, state, linear(matrix)) == pytest.approx(after[order])


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


@given(rules, st.floats(0.1, 2), st.floats(-1, 1), st.floats(-0.5, 0.5), st.integers(1, 3), seeds)
def test_goals_to_either_side_of_the_motion_are_told_apart_by_nothing(rule, apart, ahead, speed, axes, seed):
    """Goals mirrored in the line of motion, and alternatives mirrored with them."""
    goals = np.array([[apart, ahead], [-apart, ahead]])
    u = np.zeros(axes)
    u[0] = np.random.default_rng(seed).choice([-1.0, 1.0])
    matrix = np.zeros((axes, 2))
    matrix[0, 1] = speed
    if axes > 1:
        matrix[1, 0] = speed
    model = rule(goals, prior=np.array([0.3, 0.7]))
    after = model.update(model.initial(), u, np.zeros(2), linear(matrix))
    assert after == pytest.approx([0.3, 0.7], abs=1e-9)


@given(rules, st.integers(0, COUNT - 1), st.floats(0.2, 1.0), st.integers(1, 3))
def test_moving_straight_to_a_goal_raises_its_probability(rule, goal, size, axes):
    state = GOALS.mean(axis=0)
    away = GOALS[goal] - state
    rest = np.linalg.svd(GOALS - state)[2][COUNT : COUNT + axes - 1]
    matrix = 0.3 * np.vstack([away / np.linalg.norm(away), rest])
    u = np.zeros(axes)
    u[0] = size
    model = rule(GOALS)
    belief = model.initial()
    for _ in range(150):
        after = model.update(belief, u, state, linear(matrix))
        assert after[goal] > belief[goal] or after[goal] > 0.97
        belief = after
    assert belief.argmax() == goal


def test_a_person_can_change_their_mind(rule):
    model = rule(GOALS, floor=0.01)
    belief, state = model.initial(), np.zeros(DOF)
    for goal in (0, 1):
        for _ in range(3000):
            belief = model.update(
                belief, np.array([1.0, 0.0]), state, linear(np.stack([GOALS[goal], -GOALS[2]]) / 5)
            )
        assert belief.argmax() == goal
        assert belief[goal] == pytest.approx(0.98)


@given(rules, seeds, st.integers(1, 4))
def test_many_at_once_are_as_each_alone(rule, seed, axes):
    rng = np.random.default_rng(seed)
    model = rule(GOALS)
    shape = (2, 5)
    belief = rng.dirichlet(np.ones(COUNT), size=shape)
    u, state = rng.uniform(-1, 1, (*shape, axes)), rng.normal(size=(*shape, DOF))
    u[0, 0], u[0, 1], u[1, 2] = 0.0, np.nan, np.inf
    matrices = rng.normal(size=(*shape, axes, DOF))
    matrices[1, 3] = np.nan
    together = model.update(belief, u, state, lambda inputs: np.tanh(inputs @ matrices))
    for index in np.ndindex(shape):
        matrix = matrices[index]
        alone = model.update(
            belief[index], u[index], state[index], lambda inputs, matrix=matrix: np.tanh(inputs @ matrix)
        )
        np.testing.assert_allclose(together[index], alone, rtol=1e-12)
    for index in ((0, 0), (0, 1), (1, 2), (1, 3)):
        assert np.array_equal(together[index], belief[index])


def test_one_belief_is_shared_out_over_many_people(rule, rng):
    model = rule(GOALS)
    for u in (rng.uniform(-1, 1, (6, 2)), np.zeros((6, 2))):
        assert model.update(model.initial(), u, np.zeros(DOF), linear(np.ones((2, DOF)))).shape == (6, COUNT)


@given(rules, hnp.arrays(float, 2, elements=anything), hnp.arrays(float, (2, DOF), elements=anything))
def test_inputs_and_actions_that_are_no_numbers_leave_a_sound_belief(rule, u, matrix):
    model = rule(GOALS)
    after = model.update(model.initial(), u, np.zeros(DOF), linear(matrix))
    assert after.sum() == pytest.approx(1.0)
    assert (after >= model.floor).all()


@given(rules, hnp.arrays(float, (4, DOF), elements=anything), hnp.arrays(float, DOF, elements=anything))
def test_what_is_seen_may_be_anything_too(rule, actions, state):
    model = rule(GOALS)
    after = model.observe(model.initial(), state, actions)
    assert after.sum() == pytest.approx(1.0)
    if not np.isfinite(actions).all():
        assert np.array_equal(after, model.initial())


@given(rules, inputs, states, maps)
def test_no_rationality_learns_nothing(rule, u, state, matrix):
    name = {"boltzmann": "beta", "distance": "beta", "maximum_entropy": "cost_per_rad"}
    blind = next(rule(GOALS, **{name[key]: 0.0}) for key in BELIEFS if BELIEFS[key] is rule)
    assert blind.update(blind.initial(), u, state, linear(matrix)) == pytest.approx(1 / COUNT)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"period_s": float("inf")}, "period_s"),
        ({"period_s": 0.0}, "period_s"),
        ({"floor": 0.4}, "floor"),
        ({"floor": 1 / 3}, "floor"),
        ({"floor": float("nan")}, "floor"),
        ({"prior": np.array([0.5, 0.5])}, "prior"),
        ({"prior": np.array([1.0, 0.0, 0.0])}, "prior"),
        ({"goals": np.full((2, DOF), np.nan)}, "goal"),
        ({"goals": np.zeros((0, DOF))}, "goal"),
    ],
)
def test_parameters_out_of_range_are_refused(rule, wrong, named):
    with pytest.raises(UserError, match=named):
        rule(**{"goals": GOALS, **wrong})


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
