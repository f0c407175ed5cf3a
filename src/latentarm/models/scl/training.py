"""A decoder that is linear in z, with a matrix that depends on the context."""

from dataclasses import dataclass
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.scl import runtime


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SCL(NeuralModel):
    """State-conditioned linear decoder ``phi(z, c) = M(c) z`` (Przystupa et al., arXiv 2410.21441).

    A network gives d columns, which Gram-Schmidt makes orthonormal: M(c)^T M(c) = 1. So, by construction, z =
    0 is rest (phi(0, c) = 0), reversing z reverses the motion, and the speed grows with ‖z‖ equally
    everywhere. The encoder is least squares through M, which for orthonormal columns is
    ``psi(c, a) = M(c)^T a``: the best possible z, without weights.
    """

    kind: ClassVar[ModelKind] = runtime.SCL

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        columns = _columns(networks, batch.context, batch.action.shape[-1])
        return reconstruction_error(batch.action, _combine(columns, _project(columns, batch.action)))

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return _project(_columns(networks, context, action.shape[-1]), action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        joints = networks["decoder"][-1][0].shape[-1] // latent.shape[-1]
        return _combine(_columns(networks, context, joints), latent)


def _columns(networks: Networks, context: Tensor, joints: int) -> list[Tensor]:
    """The d orthonormal columns of M(c), each (S, B, m)."""
    done: list[Tensor] = []
    for raw in mlp(networks["decoder"], context).split(joints, dim=-1):
        column = raw
        for other in done:
            column = column - (column * other).sum(-1, keepdim=True) * other
        done.append(column * (column.square().sum(-1, keepdim=True) + NORM_FLOOR).rsqrt())
    return done


def _project(columns: list[Tensor], action: Tensor) -> Tensor:
    """M^T a, (S, B, d)."""
    return torch.cat([(column * action).sum(-1, keepdim=True) for column in columns], dim=-1)


def _combine(columns: list[Tensor], latent: Tensor) -> Tensor:
    """M z, (S, B, m)."""
    terms = [column * z for column, z in zip(columns, latent.split(1, dim=-1), strict=True)]
    return torch.stack(terms).sum(0)
