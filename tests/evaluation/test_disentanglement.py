import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.evaluation.disentanglement import disentanglement_deg
from latentarm.evaluation.effects import axis_effects, axis_grid

GRID = axis_grid(5)


def angle_of(decoder, chain, states):
    return disentanglement_deg(axis_effects([decoder], states, GRID, chain, step_s=0.1))


def test_a_rotation_keeps_its_axes_at_a_right_angle_everywhere(turning_decoder, gantry):
    states = np.random.default_rng(0).normal(size=(10, 2))
    assert angle_of(turning_decoder(1.7), gantry, states) == pytest.approx(90.0)


@given(angle=st.floats(0.0, 180.0))
def test_the_angle_between_two_lines_is_found(angle, gantry, linear_decoder):
    radians = np.radians(angle)
    decoder = linear_decoder(np.array([[1.0, 3.0 * np.cos(radians)], [0.0, 3.0 * np.sin(radians)]]))
    found = angle_of(decoder, gantry, np.zeros((3, 2)))
    assert found == pytest.approx(min(angle, 180.0 - angle), abs=1e-7)


def test_a_drift_that_both_axes_share_does_not_count(linear_decoder, gantry):
    decoder = linear_decoder(np.eye(2), offset=np.array([5.0, 5.0]))
    assert angle_of(decoder, gantry, np.zeros((3, 2))) == pytest.approx(90.0)


def test_one_axis_or_a_dead_one_has_no_angle(linear_decoder, gantry):
    assert np.isnan(angle_of(linear_decoder(np.ones((2, 1))), gantry, np.zeros((3, 2))))
    assert np.isnan(angle_of(linear_decoder(np.array([[1.0, 0.0], [0.0, 0.0]])), gantry, np.zeros((3, 2))))


def test_what_is_left_of_a_dead_axis_is_not_taken_for_a_direction(linear_decoder, gantry):
    """A collapsed dimension leaves rounding, whose directions are chance, beside the other or a drift."""
    beside_a_live_one = linear_decoder(np.array([[1.0, 0.0], [0.0, 1e-6]]))
    beside_a_drift = linear_decoder(1e-6 * np.eye(2), offset=np.array([1.0, 0.0]))
    for decoder in (beside_a_live_one, beside_a_drift):
        assert np.isnan(angle_of(decoder, gantry, np.zeros((3, 2))))
    weak = linear_decoder(np.array([[1.0, 0.0], [0.0, 0.05]]))
    assert angle_of(weak, gantry, np.zeros((3, 2))) == pytest.approx(90.0)
