from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.demonstrations.pairs import make_pairs
from latentarm.robots.kinematics.stillness import moving_range


def one_joint(state: list[float], timestamp: list[float], **more: object) -> Demonstrations:
    episode = Episode(state=np.array(state)[:, None], timestamp=np.array(timestamp), **more)
    return Demonstrations((episode,), rate_hz=10.0, joint_names=("elbow",))


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_a_case_worked_by_hand() -> None:
    pairs = make_pairs(one_joint([0.0, 0.1, 0.4], [0.0, 0.1, 0.3]), 2, 0.0, "state", rng())
    worked = [
        (0.0, +0.1 / 0.1),  # from the first sample to the second
        (0.0, +0.4 / 0.3),  # and on to the third, over the time between them
        (0.1, -0.1 / 0.1),
        (0.1, +0.3 / 0.2),
        (0.4, -0.4 / 0.3),
        (0.4, -0.3 / 0.2),
    ]
    np.testing.assert_allclose(np.hstack([pairs.context, pairs.action]), worked)
    assert pairs.episode.tolist() == [0] * 6


def test_noise_never_reaches_the_action() -> None:
    demonstrations = one_joint(list(np.linspace(0, 1, 50)), list(np.arange(50) / 10))
    clean = make_pairs(demonstrations, 3, 0.0, "state", rng())
    noisy = make_pairs(demonstrations, 3, 0.2, "state", rng())
    np.testing.assert_array_equal(noisy.action, clean.action)
    np.testing.assert_array_equal(noisy.clean_context, clean.context)
    noise = (noisy.context - noisy.clean_context).ravel()
    assert noise.std() == pytest.approx(0.2, rel=0.15)
    assert abs(np.corrcoef(noise, noisy.action.ravel())[0, 1]) < 0.15


def test_noise_is_the_generators() -> None:
    demonstrations = one_joint([0.0, 0.1, 0.4], [0.0, 0.1, 0.3])
    first, again = (make_pairs(demonstrations, 2, 0.1, "state", rng()) for _ in range(2))
    np.testing.assert_array_equal(first.context, again.context)


def test_belief_follows_the_state_and_stays_clean() -> None:
    belief = np.array([[0.5, 0.5], [0.2, 0.8], [0.1, 0.9]])
    demonstrations = one_joint([0.0, 0.1, 0.4], [0.0, 0.1, 0.3], extras={"belief": belief})
    pairs = make_pairs(demonstrations, 1, 0.3, "state_belief", rng())
    np.testing.assert_array_equal(pairs.context[:, 1:], belief[[0, 1, 1, 2]])
    assert np.all(pairs.context[:, 0] != pairs.clean_context[:, 0])


def test_waiting_is_no_demonstration_but_a_pause_is() -> None:
    state = [0.0, 0.0, 0.0, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2, 0.2]
    time = list(np.arange(10) / 10)
    assert moving_range(np.array(state)[:, None], np.array(time)) == (2, 7)
    pairs = make_pairs(one_joint(state, time), 1, 0.0, "state", rng())
    np.testing.assert_allclose(pairs.action.ravel(), [1, -1, 0, 0, 0, 0, 1, -1], atol=1e-12)


def test_recorded_actions_are_used_when_asked_for() -> None:
    action = np.array([[1.0], [2.0], [3.0]])
    demonstrations = one_joint([0.0, 0.1, 0.4], [0.0, 0.1, 0.3], action=action)
    pairs = make_pairs(demonstrations, 1, 0.0, "state", rng(), actions="recorded")
    np.testing.assert_array_equal(pairs.action, action)
    assert len(make_pairs(demonstrations, 1, 0.0, "state", rng()).action) == 4


@pytest.mark.parametrize(
    ("window", "noise", "context", "actions", "sentence"),
    [
        (0, 0.0, "state", "displacement", "window is 0"),
        (1, -1.0, "state", "displacement", "noise is -1"),
        (1, float("nan"), "state", "displacement", "noise is nan"),
        (1, 0.0, "state_belief", "displacement", "Episode 0 has no belief"),
        (1, 0.0, "state", "recorded", "Episode 0 has no recorded actions"),
    ],
)
def test_what_cannot_be_drawn_is_said(
    window: int, noise: float, context: str, actions: str, sentence: str
) -> None:
    with pytest.raises(UserError, match=sentence):
        make_pairs(one_joint([0.0, 1.0], [0.0, 0.1]), window, noise, context, rng(), actions=actions)


def test_an_arm_that_never_moves_teaches_nothing() -> None:
    with pytest.raises(UserError, match="never moves"):
        make_pairs(one_joint([0.5] * 9, list(np.arange(9) / 10)), 2, 0.0, "state", rng())


@given(
    window=st.integers(1, 6),
    samples=st.lists(st.integers(2, 12), min_size=1, max_size=4),
    seed=st.integers(0, 2**32 - 1),
)
def test_every_pair_ends_where_the_demonstration_was(window: int, samples: list[int], seed: int) -> None:
    """From a pair's state, its action leads to a state of the same episode within the window."""
    dice = np.random.default_rng(seed)
    episodes = tuple(
        Episode(dice.uniform(-1, 1, (count, 2)), np.cumsum(dice.uniform(0.05, 0.2, count)))
        for count in samples
    )
    pairs = make_pairs(Demonstrations(episodes, 10.0, ("a", "b")), window, 0.1, "state", dice)
    for index, (start, action) in enumerate(zip(pairs.clean_context, pairs.action, strict=True)):
        episode = episodes[pairs.episode[index]]
        here = int(np.argmin(np.abs(episode.state - start).sum(axis=1)))
        ends = [start + action * abs(time - episode.timestamp[here]) for time in episode.timestamp]
        reached = np.isclose(ends, episode.state, atol=1e-9).all(axis=1) & (ends != start).any(axis=1)
        assert any(reached & (np.abs(np.arange(len(ends)) - here) <= window))


def test_both_directions_of_a_motion_are_drawn(demonstrations: Demonstrations) -> None:
    pairs = make_pairs(demonstrations, 1, 0.0, "state", rng())
    speed = pairs.action[:, 0]
    assert np.sum(speed > 0) == np.sum(speed < 0) == len(speed) / 2


def test_a_faster_clock_gives_faster_actions(episode_of: Callable[..., Episode]) -> None:
    def actions(episode: Episode) -> FloatArray:
        return make_pairs(Demonstrations((episode,), 10.0, ("a", "b", "c")), 2, 0.0, "state", rng()).action

    episode = episode_of(0)
    hurried = replace(episode, timestamp=episode.timestamp / 2)
    np.testing.assert_allclose(actions(hurried), 2 * actions(episode))


def test_a_window_wider_than_the_motion_adds_nothing() -> None:
    demonstrations = one_joint([0.0, 0.1, 0.4], [0.0, 0.1, 0.3])
    whole, beyond = (
        make_pairs(demonstrations, window, 0.0, "state", rng()) for window in (2, 1_000_000_000_000)
    )
    np.testing.assert_array_equal(beyond.action, whole.action)
    np.testing.assert_array_equal(beyond.context, whole.context)
