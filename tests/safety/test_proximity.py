"""Heights are lower bounds of distances, now, later, and from a few ticks ago."""

import numpy as np
import pytest

from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.safety.body import Body, Placement
from latentarm.safety.proximity import Proximity

OBSTACLES = (
    HalfSpace("floor", np.array([0.0, 0.0, -0.4]), np.array([0.0, 0.0, 1.0])),
    HalfSpace("wall", np.array([0.9, 0.0, 0.0]), np.array([-0.8, 0.6, 0.0])),
    Sphere("ball", np.array([0.5, 0.2, 0.5]), 0.1),
    Capsule("rod", np.array([-0.3, 0.5, 0.0]), np.array([0.4, 0.5, 0.4]), 0.03),
    Box("box", np.array([0.3, -0.5, 0.3]), np.eye(3), np.array([0.2, 0.1, 0.2])),
)


@pytest.fixture(params=["arm", "two_arms", "gantry", "coupled"])
def robot(request):
    return request.getfixturevalue(request.param)


def everything(robot, q, obstacles=OBSTACLES):
    """A proximity for which every pair matters, with its contacts."""
    body = Body(robot)
    proximity = Proximity(body, obstacles, link_speed=0.25, nearest_m=50.0, horizon_s=0.3, clearance=0.02)
    return proximity, proximity.measured(Placement(body, q), np.full(robot.dof, 0.5))


def by_pair(proximity, contacts, heights):
    found = {}
    for pair, height in zip(contacts.pair, heights.min(axis=1), strict=True):
        name = proximity.names[pair], int(pair)
        found[name] = min(found.get(name, np.inf), height)
    return np.array(sorted(found.values()))


def test_now_heights_are_the_distances(robot, oracle):
    rng = np.random.default_rng(1)
    for _ in range(30):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        proximity, contacts = everything(robot, q)
        found = by_pair(proximity, contacts, contacts.height)
        expected = oracle(robot, OBSTACLES).distances(q)
        # Pairs that nothing can change are left out, and what overlaps is deeper in than the oracle says.
        for height in found[found > 0.0]:
            assert np.abs(expected - height).min() < 1e-6
        assert found.min() <= expected.min() + 1e-6


def test_rows_are_the_heights_derivatives_and_the_bend_bounds_the_rest(robot):
    rng = np.random.default_rng(2)
    body = Body(robot)
    bent_towards = 0
    for _ in range(40):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        way = rng.normal(size=robot.dof) * 0.03
        # Planes keep their normals, so that their heights can be followed exactly.
        proximity, contacts = everything(robot, q, OBSTACLES[:2])
        planes = np.array([name.endswith(("floor", "wall")) for name in proximity.names])[contacts.pair]
        now = contacts.height[planes]
        later = everything(robot, q + way, OBSTACLES[:2])[1].height[planes]
        nudge = everything(robot, q + 1e-6 * way, OBSTACLES[:2])[1].height[planes]
        straight = now + (contacts.row @ way)[planes]
        np.testing.assert_allclose((nudge - now) * 1e6, straight - now, atol=1e-6)
        bound = proximity.heights(contacts, way)[planes]
        assert (later >= bound - 1e-12).all()
        bent_towards += int((later < straight - 1e-6).sum())
    del body
    # Without the bend the bound would be wrong, and not rarely.
    assert bent_towards > 100


def test_later_distances_stay_above_the_heights(robot, oracle):
    rng = np.random.default_rng(3)
    measure = oracle(robot, OBSTACLES)
    for _ in range(40):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        proximity, contacts = everything(robot, q)
        way = rng.normal(size=robot.dof) * 0.02
        bound = by_pair(proximity, contacts, proximity.heights(contacts, way))
        distances = measure.distances(q + way)
        assert distances.min() >= min(bound.min(), 0.0) - 1e-9
        if bound.min() > 0.0:
            assert distances.min() >= bound.min() - 1e-9


def test_what_is_held_covers_all_that_matters(arm, oracle):
    """Contacts from a few ticks ago name every pair that could come too near now."""
    rng = np.random.default_rng(4)
    body = Body(arm)
    used = 0
    for _ in range(20):
        proximity = Proximity(
            body, OBSTACLES, link_speed=0.25, nearest_m=0.021, horizon_s=0.3, clearance=0.02
        )
        q = rng.uniform(arm.limits.lower, arm.limits.upper)
        speed = rng.uniform(0.0, 0.3, 7)
        proximity.measured(Placement(body, q), speed)
        for _ in range(20):
            q = q + rng.normal(size=7) * 0.002
            now_speed = speed * rng.uniform(0.5, 1.6)
            held = proximity.held(q, now_speed)
            if held is None:
                break
            used += 1
            fresh = Proximity(
                body, OBSTACLES, link_speed=0.25, nearest_m=0.021, horizon_s=0.3, clearance=0.02
            )
            needed = fresh.measured(Placement(body, q), now_speed)
            assert set(needed.pair) <= set(held.pair)
    assert used > 50


def test_a_shoulder_that_turns_over_the_table_does_not_matter(arm):
    body = Body(arm)
    table = HalfSpace("table", np.array([0.0, 0.0, 0.25]), np.array([0.0, 0.0, 1.0]))
    proximity = Proximity(body, (table,), link_speed=0.25, nearest_m=0.02, horizon_s=0.3, clearance=0.02)
    over_table = {name.split(" and ")[0] for name in proximity.names if name.endswith("table")}
    assert "link1" not in over_table
    assert "link5" in over_table


def test_two_arms_may_approach_each_other_at_twice_the_speed_of_one(two_arms):
    """Whatever two points at the largest speed bring too near within the horizon is among the contacts."""
    rng = np.random.default_rng(8)
    body, speed, nearest_m, horizon_s = Body(two_arms), 0.25, 0.02, 0.3
    everyone = Proximity(body, (), link_speed=speed, nearest_m=50.0, horizon_s=horizon_s, clearance=0.02)
    parts = [{part.split("_")[0] for part in name.split(" and ")} for name in everyone.names]
    across_arms = np.array([both == {"left", "right"} for both in parts])
    count, met = 0, 0
    while met < 20 and count < 5000:
        count += 1
        q = rng.uniform(two_arms.limits.lower, two_arms.limits.upper)
        proximity = Proximity(
            body, (), link_speed=speed, nearest_m=nearest_m, horizon_s=horizon_s, clearance=0.02
        )
        here = Placement(body, q)
        all_pairs = everyone.measured(here, np.ones(two_arms.dof))
        height = np.where(across_arms[all_pairs.pair], all_pairs.height.min(axis=1), np.inf)
        nearest = int(height.argmin())
        if not nearest_m + speed * horizon_s < height[nearest] < nearest_m + 1.9 * speed * horizon_s:
            continue
        met += 1
        fast = np.full(two_arms.dof, 5.0)  # joints that are no limit of their own
        assert all_pairs.pair[nearest] in proximity.measured(here, fast).pair
    assert met == 20
