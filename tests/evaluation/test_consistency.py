import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.evaluation.consistency import consistency, local_consistency, r_squared, signed_distance
from latentarm.evaluation.effects import axis_effects, axis_grid

GRID = axis_grid(11)
STATES = np.random.default_rng(0).normal(size=(25, 3))


def effects_of(decoders, chain):
    return axis_effects(decoders, STATES, GRID, chain, step_s=0.1)


def test_perfectly_proportional_motion_is_perfect_on_both_axes(linear_decoder, gantry):
    effects = effects_of([linear_decoder(np.array([[1.0, 0.5], [0.2, -2.0], [0.0, 1.0]]))], gantry)
    np.testing.assert_allclose(consistency(effects, GRID), [[1.0, 1.0]])


def test_signed_distance_is_the_way_of_the_tool_with_its_direction(linear_decoder, gantry):
    effects = effects_of([linear_decoder(np.array([[3.0], [4.0], [0.0]]))], gantry)
    expected = np.broadcast_to(5.0 * 0.1 * GRID, (1, 1, 25, 11))
    np.testing.assert_allclose(signed_distance(effects, GRID), expected, atol=1e-12)


def test_a_motion_that_turns_round_between_states_is_marked_down(formula_decoder, gantry):
    def right_or_left(z, context):
        return z[..., :1] * np.sign(context[..., :1]) * np.array([1.0, 0.0, 0.0])

    effects = effects_of([formula_decoder(1, right_or_left)], gantry)
    right = np.mean(STATES[:, 0] > 0)
    # Slope is the balance b of right over left; R^2 of that line is b^2.
    assert consistency(effects, GRID)[0, 0] == pytest.approx((2 * right - 1) ** 2)


def test_an_axis_that_turns_with_the_state_is_right_in_its_own_place(formula_decoder, gantry):
    def right_or_left(z, context):
        return z[..., :1] * np.sign(context[..., :1]) * np.array([1.0, 0.0, 0.0])

    effects = effects_of([formula_decoder(1, right_or_left)], gantry)
    np.testing.assert_allclose(local_consistency(effects, GRID), [[1.0]])


def test_a_drift_is_marked_down_in_its_own_place_too(linear_decoder, gantry):
    decoder = linear_decoder(np.array([[1.0], [0.0], [0.0]]), offset=np.array([0.0, 2.0, 0.0]))
    assert local_consistency(effects_of([decoder], gantry), GRID)[0, 0] < 0.9


def test_a_motion_that_does_not_grow_with_z_is_marked_down(formula_decoder, gantry):
    def full_speed(z, context):
        return np.sign(z[..., :1]) * np.ones(3)

    score = consistency(effects_of([formula_decoder(1, full_speed)], gantry), GRID)[0, 0]
    assert 0.7 < score < 0.9


def test_speed_that_differs_between_states_costs_its_known_share(formula_decoder, gantry):
    def by_state(z, context):
        return z[..., :1] * (2.0 + np.sign(context[..., :1])) * np.array([0.0, 1.0, 0.0])

    speed = 2.0 + np.sign(STATES[:, 0])
    score = consistency(effects_of([formula_decoder(1, by_state)], gantry), GRID)[0, 0]
    assert score == pytest.approx(speed.mean() ** 2 / np.mean(speed**2))


def test_an_axis_that_does_nothing_scores_nothing(linear_decoder, gantry):
    effects = effects_of([linear_decoder(np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]))], gantry)
    np.testing.assert_allclose(consistency(effects, GRID), [[1.0, 0.0]])


@given(
    seed=st.integers(0, 10_000),
    scale=st.floats(1e-3, 1e3).flatmap(lambda size: st.sampled_from([size, -size])),
)
def test_turning_or_scaling_z_changes_no_score(seed, scale, formula_decoder, gantry):
    rng = np.random.default_rng(seed)
    inner = rng.normal(size=(3, 3))

    def curved(gain):
        def formula(z, context):
            return gain * np.tanh(z[..., :1] + 0.3 * context @ inner) * context

        return formula_decoder(2, formula)

    plain = axis_effects([curved(1.0)], STATES, GRID, gantry, step_s=0.1)
    scaled = axis_effects([curved(scale)], STATES, GRID, gantry, step_s=0.1)
    turned = plain[..., ::-1, :]
    for score in (consistency, local_consistency):
        np.testing.assert_allclose(score(plain, GRID), score(scaled, GRID), atol=1e-9)
        np.testing.assert_allclose(score(plain, GRID), score(turned, GRID), atol=1e-9)


@given(seed=st.integers(0, 10_000), noise=st.floats(0.0, 100.0))
def test_r_squared_is_a_share(seed, noise):
    rng = np.random.default_rng(seed)
    x = np.linspace(-1.0, 1.0, 30)
    score = r_squared(x, 2.0 * x + noise * rng.normal(size=(4, 30)) + 7.0)
    assert np.all((score >= 0.0) & (score <= 1.0))


def test_r_squared_is_the_squared_correlation():
    rng = np.random.default_rng(2)
    x = rng.normal(size=50)
    y = 0.4 * x + rng.normal(size=50)
    assert r_squared(x, y) == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2)
