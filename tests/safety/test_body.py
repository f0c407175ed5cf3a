"""The proven bounds on how the arm's points move hold, in every configuration that is tried."""

import numpy as np
import pytest

from latentarm.safety.body import Body, Placement


@pytest.fixture(params=["arm", "two_arms", "gantry", "coupled"])
def body(request):
    return Body(request.getfixturevalue(request.param))


def random_states(body, count, seed):
    limits = body.robot.limits
    return np.random.default_rng(seed).uniform(limits.lower, limits.upper, (count, body.robot.dof))


def test_jacobian_agrees_with_differences(body):
    for q in random_states(body, 20, 1):
        placed = Placement(body, q)
        for joint in range(body.robot.dof):
            step = np.zeros(body.robot.dof)
            step[joint] = 1e-6
            moved = (Placement(body, q + step).points - Placement(body, q - step).points) / 2e-6
            np.testing.assert_allclose(placed.jacobian[joint, :3].T, moved, atol=1e-8)


def test_levers_bound_the_speed_of_every_point(body):
    for q in random_states(body, 300, 2):
        moved = np.linalg.norm(Placement(body, q).jacobian[:, :3], axis=1)
        assert (body.lever + 1e-9 >= moved.T).all()


# Not `coupled`, where followers that go against their leader cancel, which the bound does not see.
@pytest.mark.parametrize("body", ["arm", "two_arms", "gantry"], indirect=True)
def test_levers_are_not_wildly_pessimistic(body):
    fastest = np.max(
        [np.linalg.norm(Placement(body, q).jacobian[:, :3], axis=1).T for q in random_states(body, 2000, 3)],
        axis=0,
    )
    assert (body.lever <= 2.5 * fastest + 0.05).all()


def test_curvature_bounds_how_far_paths_bend(body):
    rng = np.random.default_rng(4)
    for q in random_states(body, 300, 5):
        way = rng.normal(size=body.robot.dof) * 0.05
        placed = Placement(body, q)
        straight = placed.points + np.tensordot(way, placed.jacobian[:, :3], axes=1).T
        bent = np.linalg.norm(Placement(body, q + way).points - straight, axis=1)
        size = np.abs(way)
        assert (bent <= 0.5 * (body.point_curvature @ size @ size) + 1e-12).all()


def test_speeds_bound_the_whole_surface(body):
    rng = np.random.default_rng(6)
    capsules, chain = body.robot.capsules, body.robot.chain
    for q in random_states(body, 100, 7):
        velocity = rng.normal(size=body.robot.dof) * 0.3
        bound = Placement(body, q).speeds(velocity)
        before, after = chain.link_transforms(q - 1e-6 * velocity), chain.link_transforms(q + 1e-6 * velocity)
        for index, capsule in enumerate(body.capsule):
            along = rng.uniform(0, 1, (50, 1))
            out = rng.normal(size=(50, 3))
            out *= capsules.radius[capsule] / np.linalg.norm(out, axis=1, keepdims=True)
            local = capsules.start[capsule] * (1 - along) + capsules.end[capsule] * along + out
            link = np.full(50, capsules.link[capsule])
            moved = chain.points(after, link, local) - chain.points(before, link, local)
            fastest = np.linalg.norm(moved / 2e-6, axis=1).max()
            assert fastest <= max(bound[index], bound[index + body.count]) + 1e-7
            lever = np.maximum(body.surface_lever[index], body.surface_lever[index + body.count])
            assert fastest <= lever @ np.abs(velocity) + 1e-7


def test_levers_of_the_surface_hold_for_each_joint_alone(body):
    """The point farthest from the axis moves fastest, by the radius faster than the segment at most."""
    for q in random_states(body, 50, 8):
        jacobian = Placement(body, q).jacobian
        fastest = np.linalg.norm(jacobian[:, :3], axis=1) + body.radius * np.linalg.norm(
            jacobian[:, 3:], axis=1
        )
        assert (body.surface_lever + 1e-9 >= fastest.T).all()
