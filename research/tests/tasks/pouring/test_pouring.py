"""The demonstrations of Plane, Pour and Reach & Pour: where the hand goes, how fast, and about which axis."""

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.robots.kinematics.rotations import pose_error
from latentarm_research.tasks.pouring.tasks import (
    AT_BOWL_M,
    FAR_LEFT_M,
    HEIGHT_M,
    HIGHEST,
    LOWEST,
    NEAR_RIGHT_M,
    PAUSE_S,
    POURING_TASKS,
    at_bowl,
)
from latentarm_research.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, TURN_RAD_S

CLOSE_M = 2e-4
"""How far off its path the hand may be, m; off its direction, rad."""

DOWN = np.diag([1.0, -1.0, -1.0])


@pytest.fixture(scope="module", params=POURING_TASKS)
def task(request):
    return POURING_TASKS[request.param]()


@pytest.fixture(scope="module")
def shown(task):
    return task.demonstrate(12, np.random.default_rng(0))


def poses(task, episode):
    return task.robot.chain.forward(episode.state)


def tilts(pose):
    """Angle about the base's x axis by which a hand that points down is turned, and how far off that axis."""
    turn = pose_error(Pose(np.zeros(3), DOWN), Pose(np.zeros_like(pose.position), pose.rotation))[..., 3:]
    return turn[..., 0], np.abs(turn[..., 1:]).max()


def twists(pose):
    """Mean velocities between samples, (T - 1, 6), m/s and rad/s."""
    before, after = (Pose(pose.position[part], pose.rotation[part]) for part in (np.s_[:-1], np.s_[1:]))
    return RATE_HZ * pose_error(before, after)


def test_names_are_those_of_the_table(task):
    assert POURING_TASKS[task.name] is type(task)


def test_joints_stay_within_their_limits(task, shown):
    limits = task.robot.limits
    assert (shown.robot, shown.joint_names) == ("panda", task.robot.joint_names)
    assert len(shown.episodes) == 12
    for episode in shown.episodes:
        np.testing.assert_allclose(np.diff(episode.timestamp), 1 / RATE_HZ)
        assert not limits.violation(episode.state).any()
        assert (np.abs(np.diff(episode.state, axis=0)) * RATE_HZ < limits.velocity).all()


def test_the_hand_is_never_faster_than_a_full_push(task, shown):
    for episode in shown.episodes:
        fastest = np.abs(twists(poses(task, episode))).max(axis=0)
        assert fastest[:3].max() < 1.02 * SPEED_M_S
        assert fastest[3] < 1.02 * TURN_RAD_S


def test_the_hand_tilts_about_the_x_axis_alone(task, shown):
    tilted = [tilts(poses(task, episode)) for episode in shown.episodes]
    assert max(off for _, off in tilted) < CLOSE_M
    reach = max(np.abs(angle).max() for angle, _ in tilted)
    assert reach < CLOSE_M if task.name == "plane" else 0.3 < reach < HIGHEST[1] + CLOSE_M


def test_the_same_seed_gives_the_same_demonstrations_and_another_seed_others(task, shown):
    again, other = (task.demonstrate(12, np.random.default_rng(seed)) for seed in (0, 1))
    for ours, same, different in zip(shown.episodes, again.episodes, other.episodes, strict=True):
        np.testing.assert_array_equal(ours.state, same.state)
        assert not np.array_equal(ours.state[0], different.state[0])


@pytest.mark.parametrize("episodes", [0, -2])
def test_no_demonstration_is_refused(task, episodes):
    with pytest.raises(UserError, match="at least one"):
        task.demonstrate(episodes, np.random.default_rng(0))


def test_plane_goes_every_way_over_the_table():
    task = POURING_TASKS["plane"]()
    ways = []
    for episode in task.demonstrate(12, np.random.default_rng(3)).episodes:
        pose = poses(task, episode)
        np.testing.assert_allclose(pose.position[:, 2], HEIGHT_M, atol=CLOSE_M)
        assert (pose.position[:, :2] > np.array(NEAR_RIGHT_M) - CLOSE_M).all()
        assert (pose.position[:, :2] < np.array(FAR_LEFT_M) + CLOSE_M).all()
        ways.append(twists(pose)[:, :2])
    for axis in np.concatenate(ways).T:
        assert axis.max() > 0.9 * SPEED_M_S
        assert axis.min() < -0.9 * SPEED_M_S


def test_pour_stays_over_one_place():
    task = POURING_TASKS["pour"]()
    for episode in task.demonstrate(12, np.random.default_rng(3)).episodes:
        pose = poses(task, episode)
        assert np.ptp(pose.position[:, :2], axis=0).max() < CLOSE_M
        assert pose.position[:, 2].min() > LOWEST[0] - CLOSE_M
        assert pose.position[:, 2].max() < HIGHEST[0] + CLOSE_M


def test_reach_and_pour_pours_where_it_is_at_the_bowl_and_nowhere_else():
    task = POURING_TASKS["reach_and_pour"]()
    for episode in task.demonstrate(20, np.random.default_rng(3)).episodes:
        pose = poses(task, episode)
        there = at_bowl(pose.position)
        first = int(there.argmax())
        assert there[first:].all()
        assert not there[:first].any()
        angle, _ = tilts(pose)
        np.testing.assert_allclose(pose.position[:first, 2], HEIGHT_M, atol=CLOSE_M)
        np.testing.assert_allclose(angle[:first], 0, atol=CLOSE_M)
        assert np.ptp(pose.position[first:, :2], axis=0).max() < CLOSE_M
        # A rest between the two, so that no motion that is asked about holds both.
        rest = episode.state[first : first + round(PAUSE_S * RATE_HZ)]
        assert np.abs(rest - rest[0]).max() < CLOSE_M


def test_at_the_bowl_is_measured_in_the_plane():
    assert at_bowl(np.array([[0.5, 0.25, 0.9], [0.5 + 0.99 * AT_BOWL_M, 0.25, 0.0]])).all()
    assert not at_bowl(np.array([0.5, 0.25 - 1.01 * AT_BOWL_M, 0.0]))
