"""What holds of the two homogeneous decoders, whatever their weights."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.demonstrations.split import select_episodes
from latentarm.models.homogeneous.runtime import DAMPING_M2
from latentarm.models.homogeneous.training import Homogeneous
from latentarm.models.low_turning.training import LowTurning
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M
from latentarm.robots.planar import planar

KINDS = [(Homogeneous, 1), (Homogeneous, 2), (Homogeneous, 3), (LowTurning, 2), (LowTurning, 3)]

coordinate = st.floats(-1.5, 1.5, allow_nan=False, width=32)
push = st.floats(-1, 1, allow_nan=False, width=32)


@pytest.fixture(scope="module", params=KINDS, ids=lambda of: f"{of[0].__name__}-{of[1]}")
def rough(request, demonstrations):
    """A model with arbitrary weights: what it promises must not hang on training."""
    kind, latent_dim = request.param
    model = kind(seeds=1, epochs=1, hidden=(8,), latent_dim=latent_dim)
    model.fit(select_episodes(demonstrations, range(4)))
    rng = np.random.default_rng(latent_dim)
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


@settings(max_examples=30)
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


@settings(max_examples=30)
@given(state=arrays(np.float64, 4, elements=coordinate), data=st.data())
def test_the_tools_speed_is_that_of_the_stick(rough, state, data):
    z = data.draw(
        arrays(np.float64, rough.latent_dim, elements=push).filter(lambda z: np.linalg.norm(z) > 1e-3)
    )
    action = rough.decoder(0).decode(z, state)
    speed = np.sqrt(action @ metric(planar(4).chain, state) @ action)
    full = rough.trained_.tensors["action.scale"][0]
    assert speed == pytest.approx(full * np.linalg.norm(z), rel=1e-5)


@settings(max_examples=20)
@given(state=arrays(np.float64, 4, elements=coordinate))
def test_every_direction_keeps_a_part_along_its_own_straight_one(rough, state):
    """The bends are metric-orthogonal to M_1, so no direction of the stick is without a motion."""
    decoder, d = rough.decoder(0), rough.latent_dim
    rng = np.random.default_rng(0)
    z = rng.normal(size=(40, d))
    z /= np.linalg.norm(z, axis=1, keepdims=True)
    assert np.isfinite(decoder.decode(z, state)).all()
    assert (np.linalg.norm(decoder.decode(z, state), axis=1) > 0).all()


def test_the_encoder_finds_the_motion_again(rough, samples):
    context = samples[0]
    rng = np.random.default_rng(7)
    z = rng.normal(size=(len(context), rough.latent_dim))
    z *= rng.uniform(0.1, 0.95, (len(z), 1)) / np.linalg.norm(z, axis=1, keepdims=True)
    action = rough.decode(z, context)[0]
    again = rough.decode(rough.encode(context, action), context)[0]
    lost = np.linalg.norm(again - action, axis=1) / np.linalg.norm(action, axis=1)
    assert np.median(lost) < 0.02
