"""The homogeneous model's bends, its encoder, and what its training does."""

import numpy as np
import pytest
import torch

from latentarm.demonstrations.pairs import make_pairs
from latentarm.models.batches import Batch
from latentarm.models.homogeneous.runtime import ORDERS, odd_degrees
from latentarm.models.homogeneous.training import Homogeneous
from latentarm.models.networks import group_layers
from latentarm.models.prepared import AHEAD_S

SMALL = {"seeds": 2, "epochs": 4, "hidden": (16,), "window": 2}


@pytest.fixture(scope="module")
def model(demonstrations):
    return Homogeneous(**SMALL).fit(demonstrations)


@pytest.mark.parametrize("degree", ORDERS)
def test_the_bends_are_harmonics_of_the_sticks_angle(degree):
    angle = np.linspace(-np.pi, np.pi, 40)
    degrees = odd_degrees(np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    column = 2 * (1 + ORDERS.index(degree))
    np.testing.assert_allclose(degrees[:, column], np.cos(degree * angle), atol=1e-12)
    sign = 1.0 if degree % 4 == 1 else -1.0
    np.testing.assert_allclose(degrees[:, column + 1], sign * np.sin(degree * angle), atol=1e-12)


def test_hardly_any_latent_action_is_nearer_than_the_encoders(model, samples):
    """Against a dense search, for any action."""
    context = samples[0]
    action = np.random.default_rng(5).normal(0.0, 0.2, context.shape)
    rebuilt = model.decode(model.encode(context, action), context)
    error = np.linalg.norm(rebuilt - action, axis=-1)
    angle = np.linspace(0, np.pi, 400)
    radius = np.linspace(-3, 3, 120)
    z = (radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    for seed in range(2):
        decoded = model.decoder(seed).decode(z, context[:, None])
        nearest = np.linalg.norm(decoded - action[:, None], axis=-1).min(axis=1)
        assert (error[seed] <= 1.02 * nearest + 1e-3).mean() > 0.9
        assert error[seed].mean() <= 1.01 * nearest.mean()


def test_the_loss_is_the_error_and_the_price_of_a_motion_that_changes_on_its_way(model, demonstrations):
    trained = model.trained_
    context = demonstrations.episodes[0].state[:20]
    action = np.random.default_rng(0).normal(0.0, 0.3, context.shape)
    ahead = context + AHEAD_S * action

    def seen(values):
        return torch.from_numpy(values).expand(2, -1, -1)

    wanted = trained.actions.apply(action)
    networks = group_layers({name: torch.from_numpy(value) for name, value in trained.tensors.items()})
    nothing = torch.zeros(2, 20, 0)
    batch = Batch(
        seen(trained.contexts.apply(context)),
        seen(wanted),
        nothing,
        nothing,
        seen(trained.contexts.apply(ahead)),
    )
    z = model.encode(context, action)
    here, there = (trained.actions.apply(model.decode(z, where)) for where in (context, ahead))
    error = np.square(here - wanted).sum(axis=(1, 2)) / 20
    change = np.square(there - here).sum(axis=(1, 2)) / 20
    np.testing.assert_allclose(model._loss(networks, batch).numpy(), error + 2.0 * change, rtol=1e-6)


def test_a_price_on_change_makes_the_opposite_push_undo_more(model, demonstrations):
    """Of the motions that were demonstrated: the price is paid there, and nowhere else."""
    free = Homogeneous(**SMALL, smoothness_weight=0.0).fit(demonstrations)
    pairs = make_pairs(demonstrations, SMALL["window"], 0.0, "state", np.random.default_rng(0))
    validation = np.isin(pairs.episode, model.validation_episodes_)
    context, action = pairs.context[validation], pairs.action[validation]

    def left_over(fitted, seed):
        """What is left of a motion after the opposite push, as a share of it."""
        z = fitted.encode(context, action)[seed]
        decoder = fitted.decoder(seed)
        there = decoder.decode(z, context)
        back = decoder.decode(-z, context + AHEAD_S * there)
        return np.linalg.norm(there + back, axis=-1).mean() / np.linalg.norm(there, axis=-1).mean()

    for seed in range(SMALL["seeds"]):
        assert left_over(model, seed) < 0.6 * left_over(free, seed)
