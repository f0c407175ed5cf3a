"""f as the control loop runs it."""

import numpy as np
import pytest
import torch

from latentarm.alignment.runtime import NETWORK, LearnedAlignment, tensor_shapes
from latentarm.models.networks import group_layers, mlp


def random_tensors(latent, context, hidden, seed=0):
    rng = np.random.default_rng(seed)
    tensors = {name: rng.normal(size=shape) for name, shape in tensor_shapes(latent, context, hidden).items()}
    return tensors | {"context.scale": rng.uniform(0.1, 2.0, context)}


@pytest.mark.parametrize(
    ("latent", "context", "hidden"), [(2, 7, (64, 64)), (1, 4, (8,)), (3, 9, ()), (2, 5, (4, 5, 6))]
)
def test_numpy_gives_what_torch_gives(latent, context, hidden):
    tensors = random_tensors(latent, context, hidden)
    alignment = LearnedAlignment(tensors)
    assert (alignment.latent_dim, alignment.context_dim, alignment.hidden) == (latent, context, hidden)
    rng = np.random.default_rng(1)
    u, c = rng.uniform(-1, 1, (20, latent)), rng.normal(size=(20, context))
    layers = group_layers(
        {name: torch.from_numpy(array)[None] for name, array in tensors.items() if name.startswith(NETWORK)}
    )
    normalised = (c - tensors["context.centre"]) / tensors["context.scale"]
    expected = mlp(layers[NETWORK], torch.from_numpy(np.concatenate([u, normalised], axis=1))[None])[0]
    np.testing.assert_allclose(alignment(u, c), expected.numpy(), rtol=1e-12, atol=1e-12)


def test_leading_axes_broadcast():
    alignment = LearnedAlignment(random_tensors(2, 4, (8, 8)))
    rng = np.random.default_rng(1)
    u, c = rng.uniform(-1, 1, (3, 5, 2)), rng.normal(size=(5, 4))
    z = alignment(u, c)
    assert z.shape == (3, 5, 2)
    np.testing.assert_allclose(alignment(u[1, 2], c[2]), z[1, 2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(alignment(u[:, 2], c[2]), z[:, 2], rtol=0, atol=1e-12)


def test_what_it_was_made_from_may_change_afterwards():
    tensors = random_tensors(2, 4, (8,))
    alignment = LearnedAlignment(tensors)
    before = alignment(np.ones(2), np.ones(4))
    for array in tensors.values():
        array *= 2
    np.testing.assert_array_equal(alignment(np.ones(2), np.ones(4)), before)
