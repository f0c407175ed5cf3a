import csv
import itertools
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.spatial import cKDTree

from latentarm.robots.kinematics.distances import segment_distance


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


def test_nothing_that_moves_is_near_the_mounting_plane_at_home(the_panda):
    start, end = the_panda.capsules.placed(the_panda.chain, the_panda.chain.link_transforms(the_panda.home))
    lowest = np.minimum(start[:, 2], end[:, 2]) - the_panda.capsules.radius
    assert lowest[the_panda.capsules.link >= 0].min() > 0.05


@pytest.fixture(scope="module")
def surface():
    """Points on the manufacturer's meshes, (K, 3) by body."""
    with (Path(__file__).parent / "panda_surface.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    bodies = {row["body"] for row in rows}
    return {
        body: np.array([[float(row[axis]) for axis in "xyz"] for row in rows if row["body"] == body])
        for body in bodies
    }


def placed(robot, surface, q):
    """Where MuJoCo puts the manufacturer's surface, (K, 3) by body."""
    model = robot.model()
    data = mujoco.MjData(model)
    data.qpos[: robot.dof] = q
    mujoco.mj_kinematics(model, data)
    return {
        body: points @ data.body(body).xmat.reshape(3, 3).T + data.body(body).xpos
        for body, points in surface.items()
    }


def states(robot, count):
    rng = np.random.default_rng(0)
    return [robot.home, *rng.uniform(robot.limits.lower, robot.limits.upper, (count, robot.dof))]


def test_its_capsules_cover_the_real_robot(the_panda, surface):
    capsules, chain = the_panda.capsules, the_panda.chain
    for q in states(the_panda, 10):
        start, end = capsules.placed(chain, chain.link_transforms(q))
        for body, points in placed(the_panda, surface, q).items():
            distance, _, _ = segment_distance(points[:, None], points[:, None], start, end)
            assert (distance - capsules.radius).min(axis=1).max() < 1e-3, body


def test_links_whose_meeting_is_not_watched_do_not_meet(the_panda, surface):
    """Between points 25 mm apart the surfaces are a little nearer than the points are."""
    never = [
        ("link0", "link2"),
        ("link1", "link3"),
        ("link2", "link4"),
        ("link3", "link5"),
        ("link4", "link6"),
    ]
    never += [("link5", "link7")]
    watched = {frozenset(the_panda.capsules.name[k] for k in pair) for pair in the_panda.self_pairs.tolist()}
    assert not watched & {frozenset(pair) for pair in never}
    # A hand folded back may well hit the forearm, though the flange cannot.
    assert frozenset(("link5", "hand")) in watched
    lower, upper = the_panda.limits.lower, the_panda.limits.upper
    for share in itertools.product((0.0, 0.5, 1.0), repeat=7):
        if share[0] or share[1:3] != share[3:5]:
            continue
        at = placed(the_panda, surface, lower + np.array(share) * (upper - lower))
        for one, other in never:
            assert cKDTree(at[one]).query(at[other])[0].min() > 0.018, (one, other, share)
