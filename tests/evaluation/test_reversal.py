import numpy as np
import pytest

from latentarm.evaluation.reversal import reversal

Z = np.array([[[1.0, 0.0], [0.0, 1.0], [-0.6, 0.8]]])


def test_a_linear_decoder_undoes_its_motion(linear_decoder):
    left = reversal([linear_decoder(np.diag([2.0, 3.0]))], Z, np.zeros((3, 2)), step_s=0.1)
    assert left == pytest.approx(0.0, abs=1e-15)


def test_a_decoder_deaf_to_z_goes_twice_as_far(linear_decoder):
    left = reversal([linear_decoder(np.zeros((2, 2)), offset=0.5)], Z, np.zeros((3, 2)), step_s=0.1)
    assert left == pytest.approx(2.0)


def test_what_a_turning_decoder_leaves_is_known(turning_decoder):
    # z = (1, 0) at s = 0 moves joint 0 by dt; there the way back is turned by rate * dt.
    rate, step_s = 2.0, 0.25
    left = reversal([turning_decoder(rate)], np.array([[[1.0, 0.0]]]), np.zeros((1, 2)), step_s)
    assert left == pytest.approx(2.0 * np.sin(rate * step_s / 2.0))


def test_a_long_hold_follows_the_decoder_all_the_way(turning_decoder, linear_decoder):
    # Held, z = (1, 0) turns with joint 0. Against small steps of the same motion by hand:
    rate, at = 1.5, np.zeros(2)
    for sign in (1.0, -1.0):
        for _ in range(4):
            at = at + 0.25 * sign * np.array([np.cos(rate * at[0]), np.sin(rate * at[0])])
        if sign > 0:
            there = np.linalg.norm(at)
    z, context = np.array([[[1.0, 0.0]]]), np.zeros((1, 2))
    left = reversal([turning_decoder(rate)], z, context, step_s=0.25, hold_s=1.0)
    assert left == pytest.approx(np.linalg.norm(at) / there)
    # The hold is as long as asked for even where no number of steps fits.
    odd = reversal([turning_decoder(rate)], z, context, step_s=0.3, hold_s=0.25)
    assert odd == pytest.approx(2.0 * np.sin(rate * 0.25 / 2.0))
    assert reversal([linear_decoder(np.eye(2))], Z, np.zeros((3, 2)), 0.1, 2.0) == pytest.approx(
        0.0, abs=1e-12
    )


def test_an_arm_that_leaves_all_bounds_has_no_figure(formula_decoder):
    explodes = formula_decoder(2, lambda z, context: z + 1e200 * context[..., :2])
    assert np.isnan(reversal([explodes], Z, np.ones((3, 2)), step_s=0.1, hold_s=2.0))


def test_the_belief_stays_as_it_is_on_the_way(formula_decoder):
    def by_belief(z, context):
        return z * context[..., 2:3]

    decoder = formula_decoder(2, by_belief)
    context = np.array([[0.0, 0.0, 0.7], [1.0, 0.0, 0.2], [0.0, 2.0, 0.5]])
    assert reversal([decoder], Z, context, step_s=0.3) == pytest.approx(0.0, abs=1e-15)


def test_a_decoder_that_never_moves_has_no_figure(linear_decoder):
    assert np.isnan(reversal([linear_decoder(np.zeros((2, 2)))], Z, np.zeros((3, 2)), step_s=0.1))
