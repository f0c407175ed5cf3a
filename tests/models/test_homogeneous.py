"""What holds of the homogeneous model whatever its weights, and what its training does."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.split import select_episodes
from latentarm.models.batches import Batch
from latentarm.models.homogeneous.runtime import DAMPING_M2, ORDERS, odd_degrees
from latentarm.models.homogeneous.training import Homogeneous
from latentarm.models.networks import group_layers
from latentarm.models.prepared import AHEAD_S
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M
from latentarm.robots.planar import planar

SMALL = {"seeds": 2, "epochs": 4, "hidden": (16,), "window": 2}

coordinate = st.floats(-1.5, 1.5, allow_nan=False, width=32)
push = st.floats(-1, 1, allow_nan=False, width=32)


@pytest.fixture(scope="module")
def model(demonstrations):
    return Homogeneous(**SMALL).fit(demonstrations)


@pytest.fixture(scope="module", params=[1, 2, 3])
def rough(request, demonstrations):
    """A model with arbitrary weights: what it promises must not hang on training."""
    model = Homogeneous(seeds=1, epochs=1, hidden=(8,), latent_dim=request.param)
    model.fit(select_episodes(demonstrations, range(4)))
    rng = np.random.default_rng(request.param)
    tensors = {
        name: values + rng.normal(0.0, 0.8, values.shape) if name.startswith("decoder.") else values
        for name, values in model.trained_.tensors.items()
    }
    model.trained_ = replace(model.trained_, tensors=tensors)
    return model


def metric(chain, state):
    """G(s) by its definition, from the chain alone."""
    weight = np.diag([1.0] * 3 + [ROTATION_WEIGHT_M**2] * 3)
    jacobian = chain.jacobian(state)
    return jacobian.T @ weight @ jacobian + DAMPING_M2 * np.eye(chain.dof)


@settings(max_examples=80)
@given(
    state=arrays(np.float64, 4, elements=coordinate),
    share=st.floats(-1.5, 1.5, allow_nan=False, width=32),
    data=st.data(),
)
def test_a_share_of_a_push_is_that_share_of_the_motion(rough, state, share, data):
    z = data.draw(arrays(np.float64, rough.latent_dim, elements=push))
    decoder = rough.decoder(0)
    motion = decoder.decode(z, state)
    np.testing.assert_allclose(decoder.decode(share * z, state), share * motion, atol=1e-9)
    np.testing.assert_array_equal(decoder.decode(0 * z, state), 0.0)
    np.testing.assert_array_equal(decoder.decode(-z, state), -motion)


@settings(max_examples=80)
@given(state=arrays(np.float64, 4, elements=coordinate), data=st.data())
def test_the_tools_speed_is_that_of_the_stick(rough, state, data):
    z = data.draw(
        arrays(np.float64, rough.latent_dim, elements=push).filter(lambda z: np.linalg.norm(z) > 1e-3)
    )
    action = rough.decoder(0).decode(z, state)
    speed = np.sqrt(action @ metric(planar(4).chain, state) @ action)
    full = rough.trained_.tensors["action.scale"][0]
    assert speed == pytest.approx(full * np.linalg.norm(z), rel=1e-5)


@settings(max_examples=40)
@given(state=arrays(np.float64, 4, elements=coordinate))
def test_every_direction_keeps_a_part_along_its_own_straight_one(rough, state):
    """The bends are metric-orthogonal to M_1, so no direction of the stick is without a motion."""
    decoder, d = rough.decoder(0), rough.latent_dim
    rng = np.random.default_rng(0)
    z = rng.normal(size=(40, d))
    z /= np.linalg.norm(z, axis=1, keepdims=True)
    assert np.isfinite(decoder.decode(z, state)).all()
    assert (np.linalg.norm(decoder.decode(z, state), axis=1) > 0).all()


@pytest.mark.parametrize("degree", ORDERS)
def test_the_bends_are_harmonics_of_the_sticks_angle(degree):
    angle = np.linspace(-np.pi, np.pi, 40)
    degrees = odd_degrees(np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    column = 2 * (1 + ORDERS.index(degree))
    np.testing.assert_allclose(degrees[:, column], np.cos(degree * angle), atol=1e-12)
    sign = 1.0 if degree % 4 == 1 else -1.0
    np.testing.assert_allclose(degrees[:, column + 1], sign * np.sin(degree * angle), atol=1e-12)


def test_the_encoder_finds_the_motion_again(rough, samples):
    context = samples[0]
    rng = np.random.default_rng(7)
    z = rng.normal(size=(len(context), rough.latent_dim))
    z *= rng.uniform(0.1, 0.95, (len(z), 1)) / np.linalg.norm(z, axis=1, keepdims=True)
    action = rough.decode(z, context)[0]
    again = rough.decode(rough.encode(context, action), context)[0]
    lost = np.linalg.norm(again - action, axis=1) / np.linalg.norm(action, axis=1)
    assert np.median(lost) < 0.02


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
