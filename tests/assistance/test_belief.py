import time

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.errors import UserError

DOF, COUNT = 7, 3
GOALS = np.random.default_rng(0).normal(0.0, 1.0, (COUNT, DOF))

states = hnp.arrays(float, DOF, elements=st.floats(-3, 3))
inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))
weights = hnp.arrays(float, COUNT, elements=st.floats(0.01, 1))
maps = hnp.arrays(float, (2, DOF), elements=st.floats(-1, 1))


def linear(matrix):
    return lambda u: u @ matrix


@given(weights, inputs, states, maps)
def test_a_belief_stays_a_distribution_above_its_floor(prior, u, state, matrix):
    model = BoltzmannBelief(GOALS, beta=50.0, floor=0.02, prior=prior)
    belief = model.initial()
    for _ in range(3):
        belief = model.update(belief, u, state, linear(matrix))
    assert belief.sum() == pytest.approx(1.0)
    assert (belief >= 0.02 - 1e-12).all()


@given(weights, states, maps)
def test_an_input_of_zero_says_nothing(prior, state, matrix):
    model = BoltzmannBelief(GOALS, prior=prior)
    belief = model.initial()
    assert np.array_equal(model.update(belief, np.zeros(2), state, linear(matrix)), belief)


@given(weights, inputs, states, maps, st.permutations(range(COUNT)))
def test_naming_the_goals_in_another_order_changes_nothing_else(prior, u, state, matrix, order):
    model, shuffled = BoltzmannBelief(GOALS, prior=prior), BoltzmannBelief(GOALS[order], prior=prior[order])
    after = model.update(model.initial(), u, state, linear(matrix))
    assert shuffled.update(shuffled.initial(), u, state, linear(matrix)) == pytest.approx(after[order])


@given(st.integers(0, COUNT - 1), st.floats(0.2, 1.0), st.integers(1, 3))
def test_moving_straight_to_a_goal_raises_its_probability(goal, size, inputs_of_person):
    state = GOALS.mean(axis=0)
    away = GOALS[goal] - state
    rest = np.linalg.svd(GOALS - state)[2][COUNT : COUNT + inputs_of_person - 1]
    matrix = 0.3 * np.vstack([away / np.linalg.norm(away), rest])
    u = np.zeros(inputs_of_person)
    u[0] = size
    model = BoltzmannBelief(GOALS)
    belief = model.initial()
    for _ in range(20):
        after = model.update(belief, u, state, linear(matrix))
        assert after[goal] > belief[goal] or after[goal] > 0.97
        belief = after
    assert belief.argmax() == goal


@given(inputs, states, maps)
def test_the_rate_of_the_loop_does_not_matter(u, state, matrix):
    slow, fast = (BoltzmannBelief(GOALS, period_s=period, floor=0.0) for period in (0.1, 0.05))
    once = slow.update(slow.initial(), u, state, linear(matrix))
    twice = fast.update(fast.update(fast.initial(), u, state, linear(matrix)), u, state, linear(matrix))
    assert twice == pytest.approx(once)


def test_thousands_of_updates_stay_sound_and_a_person_can_still_change_their_mind():
    model = BoltzmannBelief(GOALS, beta=1e4, floor=0.01)
    belief, state = model.initial(), np.zeros(DOF)
    for goal in (0, 1):
        matrix = np.stack([GOALS[goal], np.roll(GOALS[2], 1)]) / 5
        for _ in range(3000):
            belief = model.update(belief, np.array([1.0, 0.0]), state, linear(matrix))
        assert belief.argmax() == goal
        assert belief == pytest.approx(np.where(np.arange(COUNT) == goal, 0.98, 0.01))


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


@settings(max_examples=50)
@given(hnp.arrays(float, 2, elements=st.floats()), hnp.arrays(float, (2, DOF), elements=st.floats()))
def test_inputs_and_actions_that_are_no_numbers_leave_a_sound_belief(u, matrix):
    model = BoltzmannBelief(GOALS)
    with np.errstate(all="ignore"):
        after = model.update(model.initial(), u, np.zeros(DOF), linear(matrix))
    assert after.sum() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"beta": -1.0}, "beta"),
        ({"beta": float("nan")}, "beta"),
        ({"horizon_s": 0.0}, "horizon_s"),
        ({"period_s": float("inf")}, "period_s"),
        ({"floor": 0.4}, "floor"),
        ({"prior": np.array([0.5, 0.5])}, "prior"),
        ({"prior": np.array([1.0, 0.0, 0.0])}, "prior"),
        ({"goals": np.full((2, DOF), np.nan)}, "goal"),
    ],
)
def test_parameters_out_of_range_are_refused(wrong, named):
    with pytest.raises(UserError, match=named):
        BoltzmannBelief(**{"goals": GOALS, **wrong})


def test_an_update_costs_microseconds():
    model, matrix, state = BoltzmannBelief(GOALS), np.ones((2, DOF)) * 0.1, np.zeros(DOF)
    belief, u, action_of = model.initial(), np.array([0.3, 0.4]), linear(matrix)
    model.update(belief, u, state, action_of)
    seconds = []
    for _ in range(500):
        begin = time.perf_counter()
        model.update(belief, u, state, action_of)
        seconds.append(time.perf_counter() - begin)
    # The aim is 25 µs; four times that leaves room for a busy machine.
    assert np.median(seconds) < 100e-6
