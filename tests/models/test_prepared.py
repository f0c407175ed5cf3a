"""Where an action leads, as a loss sees it: what the tool holds has come along."""

import numpy as np

from latentarm.core.types import Demonstrations, Episode, Pose
from latentarm.demonstrations.contexts import context_layout
from latentarm.demonstrations.held import moved_to
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.models.prepared import AHEAD_S, Preparation, prepare
from latentarm.robots.kinematics.pose_rows import stored_rows
from latentarm.robots.planar import planar

ARM = planar(3)
FEATURES = ("joints", "objects")


def carrying(seed):
    """An arm that carries a cup between its fingers."""
    state = 0.3 + np.cumsum(np.random.default_rng(seed).uniform(0.02, 0.05, (20, 3)), axis=0)
    tool = ARM.chain.forward(state)
    stored = stored_rows(Pose(tool.position, tool.rotation))
    return Episode(state, np.arange(20) / 20.0, "carry", extras={ENVIRONMENT: stored})


def test_the_context_that_an_action_leads_to_has_what_is_held_there():
    episodes = tuple(carrying(seed) for seed in range(2))
    demonstrations = Demonstrations(episodes, 20.0, ("a", "b", "c"), objects=("cup",))
    layout = context_layout(demonstrations, FEATURES)
    rng = np.random.default_rng(0)
    pairs = make_pairs(demonstrations, 1, 0.0, FEATURES, rng, chain=ARM.chain)
    asked = Preparation(None, looks_ahead=True, data_seed=0)
    prepared = prepare(asked, pairs, layout, [1], ARM.chain, None)
    inside = pairs.episode == 0
    state = pairs.context[inside, :3] + AHEAD_S * pairs.action[inside]
    expected = moved_to(ARM.chain, layout, pairs.context[inside], pairs.held[inside], state)
    assert pairs.held[inside].mean() > 0.9
    np.testing.assert_allclose(prepared.data.later, prepared.contexts.apply(expected), atol=1e-12)
