"""A conditional flow over actions, of whose dimensions a person steers d; trained by maximum likelihood."""

from dataclasses import dataclass, field
from typing import ClassVar, Final, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.batches import Batch, TrainingData
from latentarm.models.flow.runtime import FLOW
from latentarm.models.kind import Dimensions, ModelKind
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.parameters import RANGE, Real

NORMAL_START: Final = 4.0
"""Length of the first guess of the mirrors' normals, where what an untrained network adds is about 0.5:
every seed starts near the principal actions everywhere."""

LEAST_VARIANCE: Final = 1e-4
"""Of the prior of z, so that a dimension that is not used cannot make the likelihood infinite."""


def principal_start(data: TrainingData, dimensions: Dimensions) -> dict[str, FloatArray]:
    """Begin with mirrors that take the first d axes to the principal actions, up to their signs."""
    principal = np.linalg.eigh(data.action.T @ data.action)[1][:, ::-1][:, : dimensions.latent]
    normals: list[FloatArray] = []
    for axis in range(dimensions.latent):
        # As in a QR decomposition by Householder: each mirror clears one column below its diagonal.
        normal = np.where(np.arange(dimensions.action) < axis, 0.0, principal[:, axis])
        normal[axis] += np.copysign(np.linalg.norm(normal), normal[axis])
        normal /= np.linalg.norm(normal)
        principal = principal - 2 * np.outer(normal, normal @ principal)
        normals.append(normal)
    return {
        f"decoder.{len(dimensions.hidden)}.bias": NORMAL_START * np.concatenate(normals[::-1]),
        "prior.0.weight": np.zeros(1),
        "prior.0.bias": np.full(dimensions.latent, -0.5),
    }


@final
@dataclass(kw_only=True, eq=False, repr=False)
class Flow(NeuralModel):
    """Conditional flow ``a = Q(c) (z, w + f(z, c) - f(0, c))``: z in R^d is steered, w in R^(m - d) is noise.

    An invertible map of all m dimensions in each context, of two parts that preserve volume: an additive
    coupling layer (Dinh et al., NICE, 2015, arXiv 1410.8516), which shifts w by a network f of (z, c), and
    the product Q(c) of d Householder reflections (Tomczak and Welling, 2016, arXiv 1611.09630), whose
    normals a network of the context gives. The decoder is the flow at w = 0, and the encoder its exact
    inverse: z is the first d entries of ``Q(c)^T a``. ``phi(0, c) = 0`` by construction: rest is rest.

    It is trained by maximum likelihood, with ``z ~ N(0, diag s^2)``, s learned, and ``w ~ N(0, sigma^2)``,
    sigma fixed. This is a noisy injective flow (Cunningham et al., 2020, arXiv 2006.13070) whose noise is
    normal to the motions at hand. The hard part is that a person has d of the m dimensions. The likelihood
    of a general flow does not care which: a change of volume can hide that w carries most of the motion
    (manifolds should not be learned by likelihood alone: Brehmer and Cranmer, 2020, arXiv 2003.13913), and
    a shift of z by c can explain the demonstrated action by the state alone. Here it can do neither: no
    part changes volume, nothing shifts z, and ``‖w‖ = ‖a - phi(z, c)‖`` exactly. So, but for constants and
    the factor 2 sigma^2, the negative log-likelihood is the reconstruction error plus what z costs::

        ‖a - phi(z, c)‖^2 + sigma^2 sum_i (z_i^2 / s_i^2 + log s_i^2)

    We found no flow for latent actions in the literature on teleoperation. For offline reinforcement
    learning, Akimov et al. (2022, arXiv 2211.11096) let a policy act in the latent space of a flow.

    Attributes:
        noise: sigma, as a share of the root mean square of the demonstrated joint velocities.
    """

    kind: ClassVar[ModelKind] = FLOW
    start = staticmethod(principal_start)
    noise: float = field(default=0.05, metadata={RANGE: Real(strictly=True)})

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        seen = _reflected(_normals(networks, batch.context, self.latent_dim)[::-1], batch.action)
        latent, rest = seen[..., : self.latent_dim], seen[..., self.latent_dim :]
        rest = rest - _shift(networks, latent, batch.context)
        ((weight, bias),) = networks["prior"]
        variance = (2 * (weight + bias)).exp() + LEAST_VARIANCE
        price = latent.square() / variance + variance.log()
        return (rest.square().sum(-1) + self.noise**2 * price.sum(-1)).mean(-1)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        normals = _normals(networks, context, self.latent_dim)
        return _reflected(normals[::-1], action)[..., : self.latent_dim]

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        moved = torch.cat([latent, _shift(networks, latent, context)], dim=-1)
        return _reflected(_normals(networks, context, latent.shape[-1]), moved)


def _normals(networks: Networks, context: Tensor, latent_dim: int) -> tuple[Tensor, ...]:
    """Normals of the mirrors, d of (S, B, m); of any length."""
    return mlp(networks["decoder"], context).chunk(latent_dim, dim=-1)


def _reflected(normals: tuple[Tensor, ...], vectors: Tensor) -> Tensor:
    """Vectors (S, B, m) reflected by each mirror in turn."""
    for normal in normals:
        share = (normal * vectors).sum(-1, keepdim=True)
        size = normal.square().sum(-1, keepdim=True) + NORM_FLOOR
        vectors = vectors - 2 * share / size * normal
    return vectors


def _shift(networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
    """f(z, c) - f(0, c), (S, B, m - d)."""
    pushed = torch.cat([latent, context], dim=-1)
    still = torch.cat([torch.zeros_like(latent), context], dim=-1)
    there, here = mlp(networks["shift"], torch.cat([pushed, still], dim=1)).chunk(2, dim=1)
    return there - here
