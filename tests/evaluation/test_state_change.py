import numpy as np
import pytest

from latentarm.evaluation.state_change import NEAR_RAD, state_change


def test_a_decoder_that_does_not_see_the_state_does_not_change(linear_decoder):
    z = np.ones((1, 20, 2))
    assert state_change([linear_decoder(np.diag([2.0, 3.0]))], z, np.zeros((20, 2))) == 0.0


def test_what_changes_in_proportion_to_the_state_is_known(formula_decoder):
    # phi(z, s) = z + k s: at s = 0 the action changes by k ‖s2 - s1‖, in every direction alike.
    decoder = formula_decoder(2, lambda z, context: z + 3.0 * context[..., :2])
    z = np.full((1, 50, 2), 0.5)
    changed = state_change([decoder], z, np.zeros((50, 2)))
    assert changed == pytest.approx(3.0 * NEAR_RAD / np.hypot(0.5, 0.5))


def test_the_belief_stays_as_it_is(formula_decoder):
    decoder = formula_decoder(2, lambda z, context: z * context[..., 2:])
    assert state_change([decoder], np.ones((1, 5, 2)), np.full((5, 3), 0.3)) == 0.0


def test_a_decoder_that_never_moves_has_no_figure(linear_decoder):
    assert np.isnan(state_change([linear_decoder(np.zeros((2, 2)))], np.ones((1, 3, 2)), np.zeros((3, 2))))
