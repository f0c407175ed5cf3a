from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.pauses import without_pauses
from latentarm.demonstrations.validation import validate

SPEED = np.array([0.2, -0.1])


def drives(*parts_s):
    """One episode: it moves for the first span, rests for the second, moves for the third, ..."""
    moves = np.concatenate([np.full(round(100 * span), n % 2 == 0) for n, span in enumerate(parts_s)])
    state = np.concatenate([np.zeros((1, 2)), np.cumsum(moves[:, None] * SPEED / 100, axis=0)])
    episode = Episode(state, np.arange(len(state)) / 100, task="pour")
    return Demonstrations((episode,), 100.0, ("a", "b"))


@given(st.lists(st.integers(1, 40), min_size=1, max_size=6))
def test_pauses_go_and_motions_keep_their_speed_and_their_ends(tenths):
    recorded = drives(*(span / 10 for span in tenths))
    (episode,) = without_pauses(recorded, 10.0).episodes
    assert len(episode.state) == sum(tenths[::2]) + 1
    assert np.diff(episode.state, axis=0) * 10.0 == pytest.approx(np.tile(SPEED, (len(episode.state) - 1, 1)))
    assert episode.state[0] == pytest.approx(recorded.episodes[0].state[0])
    assert episode.state[-1] == pytest.approx(recorded.episodes[0].state[-1])


def test_the_result_can_be_written_and_says_what_was_done():
    found = without_pauses(drives(1.0, 3.0, 0.55), 10.0)
    validate(found, "here")
    assert found.rate_hz == 10.0
    assert found.episodes[0].task == "pour"
    assert len(found.episodes[0].state) == 17  # 1.55 s, and what is left of the last step


def test_a_gripper_that_moves_while_the_arm_rests_is_kept():
    recorded = drives(1.0, 2.0, 1.0)
    (episode,) = recorded.episodes
    width = np.interp(episode.timestamp, [1.5, 2.5], [0.08, 0.0])[:, None]
    extras = {"observation.gripper_width": width, "action.gripper": width}
    both = replace(recorded, episodes=(replace(episode, extras=extras),))
    (found,) = without_pauses(both, 10.0).episodes
    assert set(found.extras) == {"observation.gripper_width"}
    # Open until the arm rests, closed from where it goes on.
    np.testing.assert_array_equal(found.extras["observation.gripper_width"].ravel(), [0.08] * 10 + [0.0] * 11)


def test_a_thing_that_moves_while_the_arm_rests_is_where_it_was_put():
    recorded = drives(1.0, 2.0, 1.0)
    (episode,) = recorded.episodes
    poses = np.tile([0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(episode.state), 1))
    poses[:, 1] = np.interp(episode.timestamp, [1.5, 2.5], [0.0, 0.3])
    extras = {"observation.environment_state": poses, "belief": poses}
    with_cup = replace(recorded, objects=("cup",), episodes=(replace(episode, extras=extras),))
    found = without_pauses(with_cup, 10.0)
    validate(found, "here")
    (episode,) = found.episodes
    assert set(episode.extras) == {"observation.environment_state"}
    np.testing.assert_array_equal(
        episode.extras["observation.environment_state"][:, 1], [0.0] * 10 + [0.3] * 11
    )


def test_episodes_without_motion_are_left_out():
    still, moving = drives(0.0, 2.0), drives(1.0)
    both = Demonstrations(still.episodes + moving.episodes, 100.0, ("a", "b"))
    assert len(without_pauses(both, 10.0).episodes) == 1
    with pytest.raises(UserError, match="never moves"):
        without_pauses(still, 10.0)
