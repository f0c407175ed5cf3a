import numpy as np
import pytest

from latentarm.metrics.reversal import reversal

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


def test_the_belief_stays_as_it_is_on_the_way(formula_decoder):
    def by_belief(z, context):
        return z * context[..., 2:3]

    decoder = formula_decoder(2, by_belief)
    context = np.array([[0.0, 0.0, 0.7], [1.0, 0.0, 0.2], [0.0, 2.0, 0.5]])
    assert reversal([decoder], Z, context, step_s=0.3) == pytest.approx(0.0, abs=1e-15)


def test_a_decoder_that_never_moves_has_no_figure(linear_decoder):
    assert np.isnan(reversal([linear_decoder(np.zeros((2, 2)))], Z, np.zeros((3, 2)), step_s=0.1))
