import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm_research.assistance.distance import DistanceBelief

GOALS = np.random.default_rng(0).normal(0.0, 1.0, (3, 7))


@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_a_path_says_as_much_as_its_ends(seed, steps):
    """Steps add up to exp(-beta (‖g - s_t‖ - ‖g - s_0‖)), in however many steps the path is gone."""
    rng = np.random.default_rng(seed)
    path = np.cumsum(rng.normal(0.0, 0.1, (steps + 1, 7)), axis=0)
    model = DistanceBelief(GOALS, beta=3.0, period_s=0.1, floor=0.0)
    belief = model.initial()
    for state, action in zip(path[:-1], np.diff(path, axis=0) / model.period_s, strict=True):
        belief = model.observe(belief, state, action[None])
    gone = np.linalg.norm(GOALS - path[-1], axis=-1) - np.linalg.norm(GOALS - path[0], axis=-1)
    expected = np.exp(-3.0 * gone)
    assert belief == pytest.approx(expected / expected.sum())


@given(st.integers(0, 2**32 - 1))
def test_what_else_could_have_been_done_plays_no_part(seed):
    rng = np.random.default_rng(seed)
    model, actions = DistanceBelief(GOALS), rng.normal(size=(5, 7))
    alone = model.observe(model.initial(), np.zeros(7), actions[:1])
    assert model.observe(model.initial(), np.zeros(7), actions) == pytest.approx(alone)


def test_a_step_worked_by_hand():
    """From 1 rad before one goal, and 1 rad beside the other, 0.1 rad towards the first."""
    model = DistanceBelief(np.array([[1.0, 0.0], [0.0, 1.0]]), beta=2.0, period_s=0.1, floor=0.0)
    after = model.observe(model.initial(), np.zeros(2), np.array([[1.0, 0.0]]))
    odds = np.exp(2.0 * 0.1) / np.exp(-2.0 * (np.sqrt(1.01) - 1.0))
    assert after[0] / after[1] == pytest.approx(odds)


def test_who_leaves_a_goal_is_taken_to_leave_it():
    """Unlike the Boltzmann rule: down onto the food is away from the goal above it."""
    model = DistanceBelief(np.array([[0.0, 0.0], [1.0, 0.0]]))
    after = model.observe(model.initial(), np.zeros(2), np.array([[0.0, 0.3]]))
    assert after[0] < 0.5
