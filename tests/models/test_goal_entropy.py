import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.models.autoencoders.training import CAE
from latentarm.models.goal_entropy import (
    GoalEntropy,
    goal_progress,
    log_probabilities,
)
from latentarm.models.pca.training import PCA
from latentarm.robots.kinematics.torch_chain import TorchChain
from latentarm.robots.planar import planar

GOALS = np.array([[1.0, 0.0], [-1.0, 0.0]])
speeds = st.floats(-2, 2)


def test_the_probabilities_worked_by_hand():
    # Two inputs, two goals, kappa = ln 2: scores 2, 1 for the first goal, 1/2, 4 for the second.
    progress = torch.tensor([[1.0, -1.0], [0.0, 2.0]], dtype=torch.float64)
    kappa = float(np.log(2))
    # Conveying no goal scores 2^(1/2) for each of the 2 inputs.
    assert log_probabilities(progress, kappa).exp() == pytest.approx(np.array([3.0, 4.5]) / (7.5 + 8**0.5))


@given(st.lists(st.tuples(speeds, speeds, speeds), min_size=1, max_size=5), st.floats(0.1, 20))
def test_they_are_probabilities_whatever_the_order_of_goals(rows, sharpness):
    progress = torch.tensor(rows, dtype=torch.float64)
    found = log_probabilities(progress, sharpness).exp()
    assert (found >= 0).all()
    assert 0 < float(found.sum()) < 1 + 1e-12
    order = [2, 0, 1]
    assert torch.allclose(log_probabilities(progress[:, order], sharpness).exp(), found[order])


def test_progress_is_speed_towards_a_goal_and_fades_at_the_goal():
    actions = torch.tensor([[[0.3, 0.4]]] * 2, dtype=torch.float64)
    state = torch.tensor([[0.0, 0.0], [0.95, 0.0]], dtype=torch.float64)
    progress = goal_progress(state, actions, torch.from_numpy(GOALS), speed=0.5)
    assert progress[0, 0] == pytest.approx([0.6, -0.6])
    assert progress[1, 0] == pytest.approx([0.3, -0.6])


def situation(action_of):
    return torch.zeros(1, 1, 2, dtype=torch.float64), action_of, 0.5, 1


def along(speed_there, speed_back):
    """One input from rest to full: right of zero towards the first goal, left of it towards the second."""
    ahead = torch.tensor([1.0, 0.0], dtype=torch.float64)
    return lambda u: torch.where(u > 0, speed_there * u, speed_back * u)[None, None].double() * ahead


def test_the_term_is_lowest_where_every_goal_is_open_and_standing_still_does_not_pay():
    term = GoalEntropy(GOALS, weight=1.0)
    both, one, neither = (
        float(term(*situation(along(*speeds)))) for speeds in ((0.5, 0.5), (0.5, 0.0), (0.0, 0.0))
    )
    assert both < one
    assert both < neither


def test_the_weight_scales_the_term():
    for weight in (0.0, 0.5, 3.0):
        heavy = float(GoalEntropy(GOALS, weight=weight)(*situation(along(0.5, 0.2))))
        assert heavy == pytest.approx(
            weight * float(GoalEntropy(GOALS, weight=1.0)(*situation(along(0.5, 0.2))))
        )


def test_contexts_lie_between_demonstrated_states_with_any_demonstrated_belief():
    demonstrated = np.random.default_rng(0).uniform(-1, 1, (50, 4))
    found = GoalEntropy(GOALS).contexts(demonstrated, 2, np.random.default_rng(1))
    assert found.min() >= demonstrated.min()
    assert found.max() <= demonstrated.max()
    states, beliefs = ({tuple(row) for row in demonstrated[:, half]} for half in (slice(2), slice(2, 4)))
    assert not all(tuple(row) in states for row in found[:, :2])
    assert all(tuple(row) in beliefs for row in found[:, 2:])


@pytest.mark.parametrize(
    "wrong",
    [
        {"weight": -1.0},
        {"weight": np.nan},
        {"sharpness": 0.0},
        {"per_axis": 1},
        {"goals": GOALS[:1]},
        {"goals": np.full((2, 2), np.nan)},
    ],
)
def test_parameters_out_of_range_are_refused(wrong):
    with pytest.raises(UserError):
        GoalEntropy(**{"goals": GOALS, **wrong})


def reaches(count=12):
    """Straight to one goal or the other, the belief growing on the way."""
    rng = np.random.default_rng(0)
    episodes = []
    for index in range(count):
        share = np.linspace(0, 1, 30)[:, None]
        start = rng.normal([0.0, 0.6], 0.05)
        state = (1 - share) * start + share * GOALS[index % 2]
        sure = 0.5 + 0.49 * np.clip(2 * share[:, 0], 0, 1)
        belief = np.stack([sure, 1 - sure], axis=-1)[:, :: 1 - 2 * (index % 2)]
        action = np.gradient(state, 0.05, axis=0)
        episodes.append(
            Episode(state, np.arange(30) / 20.0, action=action, extras={"belief": belief}, task="reach")
        )
    return Demonstrations(tuple(episodes), 20.0, ("a", "b"))


def fitted(term, seeds=2, seed=0):
    model = CAE(
        latent_dim=1,
        context="state_belief",
        actions="recorded",
        epochs=30,
        hidden=(16, 16),
        seeds=seeds,
        seed=seed,
    )
    return model.fit(reaches(), term=term)


def fastest_back(model):
    """Speed towards the second goal, most of any input, where the first is believed and nearly reached."""
    u = np.linspace(-1, 1, 21)[:, None]
    context = np.tile([0.8, 0.1, 0.98, 0.02], (21, 1))
    towards = GOALS[1] - context[0, :2]
    return (model.decode(u, context) @ towards / np.linalg.norm(towards)).max(axis=1)


def test_training_with_the_term_leaves_the_other_goal_open():
    plain, open_to_all = fitted(None), fitted(GoalEntropy(GOALS, weight=2.0))
    assert (fastest_back(open_to_all) > 0.4).all()
    assert (fastest_back(open_to_all) > fastest_back(plain)).all()
    shown = reaches().episodes[0]
    context = np.concatenate([shown.state, shown.extras["belief"]], axis=1)[1:-1]
    action = shown.action[1:-1]
    error = np.square(open_to_all.decode(open_to_all.encode(context, action), context) - action).sum(axis=-1)
    assert error.mean() < 0.1 * np.square(action).sum(axis=-1).mean()


@pytest.mark.usefixtures("double_precision")
def test_a_seed_trains_with_the_term_as_it_would_alone():
    context = np.random.default_rng(0).uniform(-1, 1, (9, 4))
    z = np.linspace(-1, 1, 9)[:, None]
    term = GoalEntropy(GOALS, weight=1.0)
    together, alone = fitted(term, seeds=2), fitted(term, seeds=1, seed=1)
    assert together.decode(z, context)[1] == pytest.approx(alone.decode(z, context)[0], abs=1e-9)


def test_a_closed_form_takes_no_term():
    with pytest.raises(UserError, match="closed form"):
        PCA(latent_dim=1).fit(reaches(), term=GoalEntropy(GOALS))


def test_progress_counts_the_tool_where_it_lags_behind_the_joints():
    robot = planar(3)
    rng = np.random.default_rng(0)
    goals = rng.uniform(-1, 1, (2, 3))
    state, actions = rng.uniform(-1, 1, (4, 3)), rng.normal(size=(4, 6, 3))
    tensors = [torch.from_numpy(values) for values in (state, actions, goals)]
    joints = goal_progress(*tensors, 0.5).numpy()
    both = goal_progress(*tensors, 0.5, TorchChain(robot.chain)).numpy()
    assert (both <= joints + 1e-12).all()

    # The tool's share by finite differences: how fast it nears the goal's tool, over how fast it moves
    # when the joints go straight.
    step = 1e-6
    places = robot.chain.forward(goals).position

    def away(q):
        return np.linalg.norm(robot.chain.forward(q).position[..., None, :] - places, axis=-1)

    nearing = (away(state)[:, None] - away(state[:, None] + step * actions)) / step
    straight = goals - state[:, None]
    straight /= np.linalg.norm(straight, axis=-1, keepdims=True)
    moved = robot.chain.forward(state[:, None] + step * straight).position
    moved = np.linalg.norm(moved - robot.chain.forward(state).position[:, None], axis=-1) / step
    assert both == pytest.approx(np.minimum(joints, nearing / moved[:, None] / 0.5), abs=1e-4)
