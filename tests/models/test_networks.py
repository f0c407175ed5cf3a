"""The derivative that comes with a network's output, and the norm that is estimated from it."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from latentarm.models.autoencoders.training import CAEJacobian
from latentarm.models.batches import Batch
from latentarm.models.kind import Dimensions
from latentarm.models.networks import mlp, mlp_along, networks_from_arrays


@pytest.mark.parametrize("sizes", [(3, 2), (3, 5, 2), (3, 5, 4, 2)])
def test_the_slope_along_a_direction_is_that_of_finite_differences(sizes):
    rng = torch.Generator().manual_seed(0)

    def draw(*shape):
        return torch.randn(2, *shape, generator=rng, dtype=torch.float64)

    layers = [(draw(before, width), draw(1, width)) for before, width in pairwise(sizes)]
    inputs, direction = draw(6, 3), draw(6, 3)
    value, slope = mlp_along(layers, inputs, direction)
    np.testing.assert_allclose(value, mlp(layers, inputs), rtol=1e-7, atol=1e-7)
    step = 1e-6
    there, back = (mlp(layers, inputs + way * step * direction) for way in (1, -1))
    np.testing.assert_allclose(slope, (there - back) / (2 * step), atol=1e-7, rtol=1e-6)


def test_the_jacobian_penalty_is_the_frobenius_norm():
    """Every pair is the same, so that the columns asked for in turn are all of one Jacobian's."""
    joints, latents, seeds = 3, 2, 2
    sizes = CAEJacobian.kind.weight_shapes(Dimensions(seeds, latents, joints + 1, joints, (5,)))
    rng = np.random.default_rng(0)
    networks = networks_from_arrays({name: rng.normal(size=shape) for name, shape in sizes.items()})
    context, action = (torch.from_numpy(rng.normal(size=(1, 1, width))) for width in (joints + 1, joints))
    empty = torch.empty(seeds, 0, 0, dtype=torch.float64)
    batch = Batch(context.expand(seeds, 6, -1), action.expand(seeds, 6, -1), empty, empty, empty)
    priced, free = (CAEJacobian(jacobian_weight=weight)._loss(networks, batch) for weight in (2.0, 0.0))
    model = CAEJacobian()
    latent = model._latent(networks, batch.context, batch.action)
    jacobian = torch.autograd.functional.jacobian(
        lambda state: model._action(
            networks, latent, torch.cat([state, batch.context[..., joints:]], dim=-1)
        ),
        batch.context[..., :joints],
    )
    # The belief, beyond the state, may change the motion as it likes.
    first = torch.stack([jacobian[seed, 0, :, seed, 0] for seed in range(seeds)])
    np.testing.assert_allclose(priced - free, 2 * first.square().sum(dim=(1, 2)), rtol=1e-7, atol=1e-7)
