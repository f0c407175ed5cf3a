import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.split import select_episodes, split_episodes


def some(episodes: int) -> Demonstrations:
    episode = Episode(np.zeros((2, 1)), np.arange(2.0))
    return Demonstrations((episode,) * episodes, 1.0, ("elbow",))


@given(st.integers(2, 40), st.floats(0.001, 0.999), st.integers(0, 1000))
def test_every_episode_is_on_one_side_and_neither_side_is_empty(
    count: int, fraction: float, seed: int
) -> None:
    train, kept = split_episodes(some(count), fraction, np.random.default_rng(seed))
    assert sorted([*train, *kept]) == list(range(count))
    assert len(train) > 0
    assert len(kept) > 0
    assert abs(len(kept) - fraction * count) <= 1
    again = split_episodes(some(count), fraction, np.random.default_rng(seed))
    np.testing.assert_array_equal(again[1], kept)


@pytest.mark.parametrize("fraction", [0.0, 1.0, -0.5, float("nan"), 7.0])
def test_a_fraction_that_is_none_is_refused(fraction: float) -> None:
    with pytest.raises(UserError, match="share of episodes to keep back"):
        split_episodes(some(4), fraction, np.random.default_rng(0))


def test_one_episode_cannot_be_split() -> None:
    with pytest.raises(UserError, match="at least two"):
        split_episodes(some(1), 0.5, np.random.default_rng(0))


def test_selecting_keeps_everything_else(demonstrations: Demonstrations) -> None:
    chosen = select_episodes(demonstrations, [2, 0])
    assert chosen.episodes == (demonstrations.episodes[2], demonstrations.episodes[0])
    assert (chosen.robot, chosen.goals) == (demonstrations.robot, demonstrations.goals)
    with pytest.raises(UserError, match="no episode 3"):
        select_episodes(demonstrations, [3])
