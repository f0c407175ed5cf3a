import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.planar import planar


@pytest.mark.parametrize("n_links", [1, 2, 5, 9])
def test_the_tool_is_where_the_sum_of_the_angles_puts_it(n_links):
    robot = planar(n_links)
    q = np.random.default_rng(0).uniform(-3, 3, size=(50, n_links))
    heading = np.cumsum(q, axis=1)
    expected = np.stack([np.cos(heading), np.sin(heading), np.zeros_like(q)], axis=-1).sum(axis=1) / n_links
    np.testing.assert_allclose(robot.chain.forward(q).position, expected, atol=1e-5)


def test_two_arms_stand_side_by_side_and_mirror_each_other_at_home():
    robot = planar(arms=2)
    assert robot.dof == 10
    left, right = (robot.chain.forward(robot.home, tool).position for tool in (0, 1))
    np.testing.assert_allclose(left, right * [1, -1, 1], atol=1e-12)
    assert left[1] > 0.1


def test_only_arms_that_could_collide_are_watched():
    robot = planar(arms=2)
    links = {tuple(robot.capsules.link[pair]) for pair in robot.self_pairs}
    assert (4, 9) in links
    assert (0, 1) not in links


@pytest.mark.parametrize(("n_links", "arms"), [(0, 1), (5, 0), (5, 3), (-1, 2)])
def test_arms_that_cannot_be_are_refused(n_links, arms):
    with pytest.raises(UserError, match="one or two arms"):
        planar(n_links, arms)
