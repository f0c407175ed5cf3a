"""What holds of the low-turning model whatever its weights, and what its prices are."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.demonstrations.split import select_episodes
from latentarm.metrics.turning import turning as measured_turning
from latentarm.models.batches import Batch
from latentarm.models.homogeneous.runtime import DAMPING_M2
from latentarm.models.low_turning.training import Around, LowTurning, narrowness, turning
from latentarm.models.networks import group_layers
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M
from latentarm.robots.planar import planar

SMALL = {"seeds": 2, "epochs": 4, "hidden": (16,), "window": 2}

coordinate = st.floats(-1.5, 1.5, allow_nan=False, width=32)
push = st.floats(-1, 1, allow_nan=False, width=32)


@pytest.fixture(scope="module", params=[2, 3])
def rough(request, demonstrations):
    """A model with arbitrary weights: its laws must not depend on training."""
    model = LowTurning(seeds=1, epochs=1, hidden=(8,), latent_dim=request.param)
    model.fit(select_episodes(demonstrations, range(4)))
    rng = np.random.default_rng(request.param)
    tensors = {
        name: values + rng.normal(0.0, 0.8, values.shape) if name.startswith("decoder.") else values
        for name, values in model.trained_.tensors.items()
    }
    model.trained_ = replace(model.trained_, tensors=tensors)
    return model


@settings(max_examples=60)
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


@settings(max_examples=60)
@given(state=arrays(np.float64, 4, elements=coordinate), data=st.data())
def test_the_tools_speed_is_that_of_the_stick(rough, state, data):
    z = data.draw(
        arrays(np.float64, rough.latent_dim, elements=push).filter(lambda z: np.linalg.norm(z) > 1e-3)
    )
    action = rough.decoder(0).decode(z, state)
    twist = planar(4).chain.jacobian(state) @ action * np.array([1.0] * 3 + [ROTATION_WEIGHT_M] * 3)
    speed = np.sqrt(twist @ twist + DAMPING_M2 * action @ action)
    full = rough.trained_.tensors["action.scale"][0]
    assert speed == pytest.approx(full * np.linalg.norm(z), rel=1e-5)


def test_the_encoder_finds_the_motion_again(rough, samples):
    context = samples[0]
    rng = np.random.default_rng(7)
    z = rng.normal(size=(len(context), rough.latent_dim))
    z *= rng.uniform(0.1, 0.95, (len(z), 1)) / np.linalg.norm(z, axis=1, keepdims=True)
    action = rough.decode(z, context)[0]
    again = rough.decode(rough.encode(context, action), context)[0]
    lost = np.linalg.norm(again - action, axis=1) / np.linalg.norm(action, axis=1)
    assert np.median(lost) < 0.02


def half_circle(curve, velocity):
    """One context's motions (m,) and tool velocities (3,), given as functions of the stick's angle."""
    angle = np.arange(19) * np.pi / 18
    joints = np.stack([curve(one) for one in angle], axis=-1)
    tools = np.stack([np.concatenate([velocity(one), np.zeros(3)]) for one in angle], axis=-1)
    return Around(*(torch.from_numpy(values)[None, :, None, :, None] for values in (joints, tools)))


def test_a_plane_turns_as_fast_as_the_stick_and_a_third_harmonic_faster():
    """Any ellipse is once around; of a curve that leaves its plane the length is summed finely here."""

    def bent(size):
        return lambda t: np.array([np.cos(t), np.sin(t), size * np.cos(3 * t)])

    flat = half_circle(lambda t: np.array([2 * np.cos(t), 0.5 * np.sin(t)]), lambda t: np.zeros(3))
    assert turning(flat).item() == pytest.approx(1.0, rel=0.01)
    fine = np.array([bent(0.4)(t) for t in np.linspace(0, np.pi, 20001)])
    fine /= np.linalg.norm(fine, axis=1, keepdims=True)
    length = np.linalg.norm(np.diff(fine, axis=0), axis=1).sum() / np.pi
    assert turning(half_circle(bent(0.4), lambda t: np.zeros(3))).item() == pytest.approx(length, rel=0.02)


def test_the_price_of_narrowness_is_that_of_the_velocities_gram_matrix():
    """The mean of v v^T over (cos t, sin t, 0) is diag(1/2, 1/2, 0)."""
    plane = half_circle(lambda t: np.ones(2), lambda t: np.array([np.cos(t), np.sin(t), 0.0]))
    assert narrowness(plane).item() == pytest.approx(-np.log(0.501 * 0.501 * 0.001), rel=1e-6)
    space = half_circle(
        lambda t: np.ones(2), lambda t: np.array([np.cos(t), np.sin(t), np.cos(3 * t)]) / np.sqrt(2)
    )
    assert narrowness(space).item() == pytest.approx(-3 * np.log(0.251), rel=1e-6)


@pytest.fixture(scope="module")
def priced(demonstrations):
    """By the price of turning."""
    return {
        weight: LowTurning(**SMALL, turning_weight=weight, spread_weight=0.0).fit(demonstrations)
        for weight in (0.0, 0.5)
    }


def test_the_loss_charges_for_turning_as_it_is_measured(priced, demonstrations):
    """Without noise, and in the contexts that are priced: every eighth."""
    trained = priced[0.5].trained_
    context = demonstrations.episodes[0].state[:24]
    action = np.random.default_rng(0).normal(0.0, 0.3, context.shape)

    def seen(values):
        return torch.from_numpy(values).expand(2, -1, -1)

    networks = group_layers({name: torch.from_numpy(value) for name, value in trained.tensors.items()})
    observed = seen(trained.contexts.apply(context))
    nothing = torch.zeros(2, 0, 4)
    batch = Batch(observed, seen(trained.actions.apply(action)), torch.zeros(2, 24, 4), nothing, observed)
    with torch.no_grad():
        charged = priced[0.5]._loss(networks, batch) - priced[0.0]._loss(networks, batch)
    around = measured_turning([priced[0.5].decoder(0), priced[0.5].decoder(1)], context[::8], planar(4).chain)
    np.testing.assert_allclose(charged.numpy(), 0.5 * around.joints.mean(axis=(1, 2)), rtol=0.05)


def test_a_price_on_turning_makes_the_motion_turn_less(priced, demonstrations):
    context = demonstrations.episodes[0].state[::4]
    free, charged = (
        measured_turning([model.decoder(0), model.decoder(1)], context, planar(4).chain).joints.mean()
        for model in priced.values()
    )
    assert charged < free
