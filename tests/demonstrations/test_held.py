"""Which things of a demonstration are held, and that they move with the arm."""

import numpy as np
import pytest

from latentarm.core.context import OBJECT
from latentarm.core.types import Demonstrations, Episode, Pose
from latentarm.demonstrations.contexts import context_layout
from latentarm.demonstrations.held import moved_to
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.kinematics.pose_rows import moved_along, pose_rows, stored_rows
from latentarm.robots.planar import planar

ARM = planar(3)
FEATURES = ("joints", "objects")


def fetched(rng):
    """The arm takes the first of two things along from sample 20 to 39, with a rest in between."""
    steps = rng.uniform(0.02, 0.05, (60, 3))
    steps[28:32] = 0.0
    state = 0.3 + np.cumsum(steps, axis=0)
    tool = ARM.chain.forward(state)
    place = np.array([tool.position[20] + [0.05, 0.0, 0.0], [2.0, 1.0, 0.0]])
    things = [Pose(place.copy(), np.tile(np.eye(3), (2, 1, 1)))]
    for sample in range(1, 60):
        before, after = (Pose(tool.position[k], tool.rotation[k]) for k in (sample - 1, sample))
        last = things[-1]
        position, rotation = last.position.copy(), last.rotation.copy()
        if 20 < sample < 40:
            turn = after.rotation @ before.rotation.T
            position[0] = after.position + turn @ (last.position[0] - before.position)
            rotation[0] = turn @ last.rotation[0]
        things.append(Pose(position, rotation))
    stored = np.stack([stored_rows(one).reshape(-1) for one in things])
    return Episode(state, np.arange(60) / 20.0, "fetch", extras={ENVIRONMENT: stored}), things


@pytest.fixture
def demonstrations():
    episode, _ = fetched(np.random.default_rng(0))
    return Demonstrations((episode,), 20.0, ("a", "b", "c"), objects=("cup", "plate"))


def pairs_of(demonstrations, noise, chain):
    return make_pairs(demonstrations, 1, noise, FEATURES, np.random.default_rng(0), chain=chain)


def test_what_moves_with_the_tool_is_held_also_while_both_rest(demonstrations):
    pairs = pairs_of(demonstrations, 0.0, ARM.chain)
    state = demonstrations.episodes[0].state
    # At rest several samples have the same state: of those the first is found.
    sample = np.abs(pairs.clean_context[:, None, :3] - state).sum(axis=2).argmin(axis=1)
    held = set(sample[pairs.held[:, 0]].tolist())
    assert held == set(range(20, 39)) - {28, 29, 30, 31}
    assert not pairs.held[:, 1].any()
    assert pairs.held[sample == 27, 0].all(), "those at rest are among them"


def test_what_is_held_moves_along_and_nothing_else(demonstrations):
    pairs = pairs_of(demonstrations, 0.0, ARM.chain)
    layout = context_layout(demonstrations, FEATURES)
    clean = pairs.clean_context
    state = clean[:, :3] + np.random.default_rng(1).normal(scale=0.1, size=(len(clean), 3))
    moved = moved_to(ARM.chain, layout, clean, pairs.held, state)
    np.testing.assert_array_equal(moved[:, :3], state)
    here, there = (one[:, 3:].reshape(len(one), 2, OBJECT) for one in (clean, moved))
    before, after = (ARM.chain.forward(one) for one in (clean[:, :3], state))
    expected = np.where(pairs.held[..., None], moved_along(here, before, after), here)
    np.testing.assert_allclose(there, expected, atol=1e-12)
    assert np.abs(there - here)[pairs.held].max() > 0.01


def test_of_an_arm_that_is_not_known_nothing_is_held(demonstrations):
    pairs = pairs_of(demonstrations, 0.1, None)
    assert not pairs.held.any()
    np.testing.assert_array_equal(pairs.context[:, 3:], pairs.clean_context[:, 3:])


def test_the_rows_of_a_thing_are_its_pose(demonstrations):
    _, things = fetched(np.random.default_rng(0))
    pairs = pairs_of(demonstrations, 0.0, None)
    np.testing.assert_allclose(
        pairs.clean_context[0, 3:].reshape(2, OBJECT), pose_rows(things[0]), atol=1e-12
    )


def test_noise_on_states_takes_along_what_is_held(demonstrations):
    noisy = pairs_of(demonstrations, 0.1, ARM.chain)
    layout = context_layout(demonstrations, FEATURES)
    expected = moved_to(ARM.chain, layout, noisy.clean_context, noisy.held, noisy.context[:, :3])
    np.testing.assert_array_equal(noisy.context, expected)
    assert np.abs(noisy.context - noisy.clean_context)[noisy.held.any(axis=1), 3:].max() > 0.01
