import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.evaluation.drift import drift


def unit_circle(count: int) -> np.ndarray:
    angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def test_a_linear_decoder_rests_with_the_input(linear_decoder):
    z = unit_circle(8)[None]
    assert drift([linear_decoder(np.eye(2))], z, np.zeros((8, 2))) == pytest.approx(0.0)


def test_an_offset_off_the_plane_of_motion_gives_its_known_share(linear_decoder):
    # Motion of length 4 in the plane and an offset of 3 across it: ‖phi(z)‖ = 5, ‖phi(0)‖ = 3.
    decoder = linear_decoder(4.0 * np.eye(3)[:, :2], offset=np.array([0.0, 0.0, 3.0]))
    z = unit_circle(8)[None]
    assert drift([decoder], z, np.zeros((8, 3))) == pytest.approx(3.0 / 5.0)


def test_each_seed_has_its_own_figure(linear_decoder):
    z = np.stack([unit_circle(8), unit_circle(8)])
    decoders = [linear_decoder(np.zeros((2, 2)), offset=1.0), linear_decoder(np.eye(2))]
    np.testing.assert_allclose(drift(decoders, z, np.zeros((8, 2))), [1.0, 0.0])


def test_a_decoder_that_never_moves_has_no_drift_to_speak_of(linear_decoder):
    assert np.isnan(drift([linear_decoder(np.zeros((2, 2)))], unit_circle(4)[None], np.zeros((4, 2))))


@given(scale=st.floats(1e-3, 1e3), offset=st.floats(-1.0, 1.0))
def test_faster_arms_do_not_drift_more(scale, offset, linear_decoder):
    z, context = unit_circle(6)[None], np.zeros((6, 2))
    slow = drift([linear_decoder(np.eye(2), offset)], z, context)
    fast = drift([linear_decoder(scale * np.eye(2), scale * offset)], z, context)
    np.testing.assert_allclose(slow, fast, atol=1e-12)
