import numpy as np
import pytest

from latentarm_research.metrics.nonlinearity import nonlinearity

STATES = np.zeros((4, 3))


class Bowl:
    """a = (z1, ‖z‖²), whatever the context."""

    latent_dim = 2

    def decode(self, z, context):
        shape = np.broadcast_shapes(z.shape[:-1], context.shape[:-1])
        return np.broadcast_to(np.stack([z[..., 0], np.square(z).sum(-1)], axis=-1), (*shape, 2))


def test_a_linear_map_has_none_and_a_drift_does_not_count(linear_decoder):
    class Drifting:
        latent_dim = 2

        def decode(self, z, context):
            return np.array([0.5, 0.0, -2.0]) + linear_decoder(np.ones((3, 2))).decode(z, context)

    shares = nonlinearity([linear_decoder(np.eye(3, 2)), Drifting()], STATES)
    assert shares.shape == (2, 4)
    np.testing.assert_allclose(shares, 0.0, atol=1e-12)


def test_the_share_is_the_one_worked_out_by_hand():
    """With r of 1/3, 2/3 and 1: var z1 = mean r² / 2 = 7/27, var r² = 98/243 - (14/27)² = 98/729."""
    np.testing.assert_allclose(nonlinearity([Bowl()], STATES), 98 / (98 + 7 * 27))


def test_where_nothing_moves_there_is_no_figure(linear_decoder):
    assert np.isnan(nonlinearity([linear_decoder(np.zeros((3, 2)))], STATES)).all()


def test_a_stick_of_one_axis_is_refused(linear_decoder):
    with pytest.raises(ValueError, match="two axes"):
        nonlinearity([linear_decoder(np.ones((3, 1)))], STATES)
