import numpy as np

from latentarm.kinematics.capsules import segment_distance


def gaps(robot, q):
    start, end = robot.capsules.placed(robot.chain, robot.chain.link_transforms(q))
    i, j = robot.self_pairs.T
    distance, _, _ = segment_distance(start[..., i, :], end[..., i, :], start[..., j, :], end[..., j, :])
    return distance - robot.capsules.radius[i] - robot.capsules.radius[j]


def test_limits_are_the_manufacturers(the_panda):
    limits = the_panda.limits
    np.testing.assert_array_equal(limits.lower[[3, 5]], [-3.0718, -0.0175])
    np.testing.assert_array_equal(limits.upper[[3, 5]], [-0.0698, 3.7525])
    np.testing.assert_array_equal(limits.velocity, [2.175] * 4 + [2.61] * 3)
    assert the_panda.tool_speed_limit == 1.7


def test_at_home_the_tool_points_down_in_front_of_the_robot(the_panda):
    pose = the_panda.chain.forward(the_panda.home)
    np.testing.assert_allclose(pose.position, [0.3069, 0.0, 0.4869], atol=1e-4)
    np.testing.assert_allclose(pose.rotation, np.diag([1.0, -1.0, -1.0]), atol=1e-5)


def test_it_weighs_what_a_panda_weighs(the_panda):
    assert 16.0 < the_panda.model().body_mass.sum() < 20.0


def test_it_is_clear_of_itself_at_home_and_hits_itself_when_folded_up(the_panda):
    assert gaps(the_panda, the_panda.home).min() > 0.05
    # The hand folded back into the forearm, and reaching down into the base.
    into_the_forearm = the_panda.home.copy()
    into_the_forearm[[4, 5]] = [np.pi, 0.0]
    into_the_base = np.array([0.0, 0.55, 0.0, -3.02, 0.0, 1.85, -0.78])
    assert gaps(the_panda, into_the_forearm.clip(the_panda.limits.lower, the_panda.limits.upper)).min() < 0.02
    assert gaps(the_panda, into_the_base).min() < 0.0


def test_its_shape_is_cheap_enough_to_watch_online(the_panda):
    assert len(the_panda.capsules) <= 13
    assert len(the_panda.self_pairs) <= 45


def test_it_stands_clear_of_the_table_it_is_mounted_on(the_panda):
    """Nothing that moves is near the mounting plane at home."""
    start, end = the_panda.capsules.placed(the_panda.chain, the_panda.chain.link_transforms(the_panda.home))
    lowest = np.minimum(start[:, 2], end[:, 2]) - the_panda.capsules.radius
    assert lowest[the_panda.capsules.link >= 0].min() > 0.05
    assert lowest.min() >= 0.0
