import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm_research.tasks.planar.catalogue import MOTIONS


def task_jacobian(motion, state):
    """Derivative of what the task constrains: the tool's place, of two tools the heading too."""
    tools = range(len(motion.robot.chain.tools))
    rows = (0, 1) if len(tools) == 1 else (0, 1, 5)
    return np.concatenate([motion.robot.chain.jacobian(state, tool)[..., rows, :] for tool in tools], axis=-2)


def test_names_are_those_of_the_table(motion):
    assert MOTIONS[motion.name] is type(motion)
    assert 1 <= motion.latent_dim < motion.robot.dof


def test_demonstrations_are_of_the_robot_with_a_recorded_action_at_every_state(motion, shown):
    assert (shown.robot, shown.joint_names) == (motion.robot.name, motion.robot.joint_names)
    assert len(shown.episodes) == 6
    for episode in shown.episodes:
        assert episode.state.shape == episode.action.shape == (motion.samples, motion.robot.dof)
        np.testing.assert_allclose(np.diff(episode.timestamp), 1.0 / shown.rate_hz)
        assert not motion.robot.limits.violation(episode.state).any()
        assert np.linalg.norm(episode.action, axis=-1).max() > 0


def test_actions_are_the_least_that_move_the_tools_so(motion, shown):
    """Of all joint velocities with the same motion of the tools: none of it in the Jacobian's null space."""
    for episode in shown.episodes:
        jacobian = task_jacobian(motion, episode.state)
        least = np.einsum("tnk,tkm,tm->tn", np.linalg.pinv(jacobian), jacobian, episode.action, optimize=True)
        np.testing.assert_allclose(episode.action, least, atol=1e-9)


def test_postures_differ_between_demonstrations(shown):
    first = np.array([episode.state[0] for episode in shown.episodes])
    assert np.linalg.norm(first - first[0], axis=-1)[1:].min() > 1e-3


def test_the_same_seed_gives_the_same_demonstrations_and_another_seed_others(motion, shown):
    again = motion.demonstrate(6, np.random.default_rng(0))
    other = motion.demonstrate(6, np.random.default_rng(1))
    for ours, same, different in zip(shown.episodes, again.episodes, other.episodes, strict=True):
        np.testing.assert_array_equal(ours.state, same.state)
        np.testing.assert_array_equal(ours.action, same.action)
        assert not np.array_equal(ours.state, different.state)


@pytest.mark.parametrize("episodes", [0, -3])
def test_no_demonstration_is_refused(motion, episodes):
    with pytest.raises(UserError, match="at least one"):
        motion.demonstrate(episodes, np.random.default_rng(0))


def posture_told_by_place(motion):
    """Largest correlation of a free joint with a coordinate of the task where demonstrations begin."""
    shown = motion.demonstrate(80, np.random.default_rng(5))
    first = np.array([episode.state[0] for episode in shown.episodes])
    free = np.setdiff1d(np.arange(motion.robot.dof), motion.closing)
    place = motion.constraint.coordinates(first)
    return np.abs(np.corrcoef(first[:, free].T, place.T)[: len(free), len(free) :]).max()


def test_the_place_tells_nothing_of_the_free_joints(motion, monkeypatch):
    monkeypatch.setattr(type(motion), "least_conditioning", 0.1)
    assert posture_told_by_place(motion) < 0.4


def test_ill_conditioned_postures_are_drawn_anew(motion, monkeypatch):
    monkeypatch.setattr(type(motion), "spread_rad", 0.3)
    nominal = np.linalg.svd(task_jacobian(motion, motion.nominal), compute_uv=False)[-1]
    for episode in motion.demonstrate(6, np.random.default_rng(0)).episodes:
        smallest = np.linalg.svd(task_jacobian(motion, episode.state), compute_uv=False)[:, -1]
        assert smallest.min() > motion.least_conditioning * nominal
