import numpy as np
import pytest

from latentarm.evaluation.turning import DIRECTIONS, turning
from latentarm.robots.planar import planar


class Sliding:
    """An arm whose joints are the tool's coordinates."""

    def jacobian(self, q, tool=0):
        jacobian = np.zeros((*q.shape[:-1], 6, q.shape[-1]))
        jacobian[..., range(q.shape[-1]), range(q.shape[-1])] = 1.0
        return jacobian


STATES = np.zeros((4, 3))


def test_a_linear_isometry_turns_as_the_stick_does(linear_decoder):
    basis = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 2)))[0]
    turned = turning([linear_decoder(2.5 * basis)], STATES, Sliding())
    assert turned.joints.shape == (1, 4, DIRECTIONS)
    np.testing.assert_allclose(turned.joints, 1.0)
    np.testing.assert_allclose(turned.tool, 1.0)


def test_a_stretched_circle_turns_fast_at_its_narrow_ends(linear_decoder):
    """a = (z1, z2 / 3): arctan(tan(θ) / 3) turns 3 times as fast as θ at 90°, and a third of it at 0."""
    stretched = linear_decoder(np.array([[1.0, 0.0], [0.0, 1 / 3], [0.0, 0.0]]))
    turned = turning([stretched], STATES[:1], Sliding(), directions=3600).joints[0, 0]
    assert turned.mean() == pytest.approx(1.0)
    assert turned.max() == pytest.approx(3.0, rel=1e-3)
    assert turned.min() == pytest.approx(1 / 3, rel=1e-3)


def test_one_direction_turns_about_twice_and_a_percentile_of_95_shows_it(linear_decoder):
    one = linear_decoder(np.array([[1.0, 0.01], [1.0, 0.01], [0.0, 0.0]]))
    turned = turning([one], np.zeros((10, 3)), Sliding())
    assert ((turned.joints > DIRECTIONS / 2 - 0.01).sum(axis=-1) == 2).all()
    assert np.percentile(turned.joints, 95) == pytest.approx(DIRECTIONS / 2)


def test_the_tool_turns_as_its_jacobian_says(linear_decoder):
    """Two links: the joints turn as the stick does, the tool as J, a linear map, does to a circle."""
    robot = planar(2)
    state = np.array([[0.3, 0.9]])
    turned = turning([linear_decoder(np.eye(2))], state, robot.chain, directions=3600)
    np.testing.assert_allclose(turned.joints, 1.0)
    strongest, weakest = np.linalg.svd(robot.chain.jacobian(state[0])[:2])[1]
    assert turned.tool.max() == pytest.approx(strongest / weakest, rel=1e-2)


def test_where_nothing_moves_there_is_no_figure(linear_decoder):
    assert np.isnan(turning([linear_decoder(np.zeros((3, 2)))], STATES, Sliding()).joints).all()


def test_a_stick_of_one_axis_cannot_be_led_around(linear_decoder):
    with pytest.raises(ValueError, match="two axes"):
        turning([linear_decoder(np.ones((3, 1)))], STATES, Sliding())
