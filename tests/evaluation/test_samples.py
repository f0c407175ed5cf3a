import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.evaluation.samples import (
    evenly_spread,
    moving_episodes,
    spread_contexts,
    start_goal_pairs,
)


def moving_episode(samples, still=0, rate_hz=10.0, level=0.0):
    """One joint moving at 1 rad/s, the other at ``level``, still at both ends."""
    ramp = np.pad(np.arange(samples) / rate_hz, still, mode="edge")
    state = np.stack([ramp, np.full_like(ramp, level)], axis=-1)
    return Episode(state=state, timestamp=np.arange(len(ramp)) / rate_hz)


def dataset(*episodes):
    return Demonstrations(episodes=episodes, rate_hz=10.0, joint_names=("a", "b"))


@given(count=st.integers(1, 300), total=st.integers(1, 300))
def test_a_spread_is_even_and_never_repeats(count, total):
    chosen = evenly_spread(count, total)
    assert len(chosen) == min(count, total)
    assert chosen.min() >= 0
    assert chosen.max() < total
    assert np.all(np.diff(chosen) >= 1)
    assert np.ptp(np.diff(chosen)) <= 1 if len(chosen) > 2 else True


def test_goals_lie_the_stated_time_after_their_starts_in_the_same_episode():
    episodes = (moving_episode(50, level=1.0), moving_episode(80, level=2.0))
    pairs = start_goal_pairs(episodes, "state", separation_s=3.0, count=20)
    assert pairs.start.shape == (20, 2)
    np.testing.assert_allclose(pairs.goal[:, 0] - pairs.start[:, 0], 3.0)
    np.testing.assert_allclose(pairs.goal[:, 1], pairs.start[:, 1])
    assert set(pairs.goal[:, 1]) == {1.0, 2.0}


def test_a_short_episode_gives_its_first_and_last_sample():
    pairs = start_goal_pairs((moving_episode(10),), "state", separation_s=3.0, count=20)
    np.testing.assert_allclose(pairs.start, [[0.0, 0.0]])
    np.testing.assert_allclose(pairs.goal, [[0.9, 0.0]])


def test_still_ends_are_not_measured():
    (episode,) = moving_episodes(dataset(moving_episode(30, still=20)), [0])
    np.testing.assert_allclose(episode.state[:, 0], np.arange(30) / 10.0)


def test_a_belief_follows_the_state_in_the_context():
    episode = moving_episode(30)
    belief = np.tile([0.25, 0.75], (30, 1))
    with_belief = Episode(state=episode.state, timestamp=episode.timestamp, extras={"belief": belief})
    contexts = spread_contexts([with_belief], "state_belief", 5)
    assert contexts.shape == (5, 4)
    np.testing.assert_allclose(contexts[:, 2:], belief[:5])


def test_refusals_say_what_to_do():
    with pytest.raises(UserError, match="hold out at least one"):
        moving_episodes(dataset(moving_episode(30)), [])
    with pytest.raises(UserError, match="no episode 3"):
        moving_episodes(dataset(moving_episode(30)), [3])
    with pytest.raises(UserError, match="annotate"):
        spread_contexts([moving_episode(30)], "state_belief", 5)
    still = Episode(state=np.zeros((9, 2)), timestamp=np.arange(9.0))
    with pytest.raises(UserError, match="never moves"):
        moving_episodes(dataset(still), [0])
