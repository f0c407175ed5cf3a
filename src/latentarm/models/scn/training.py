"""A decoder that is an odd network of z, with weights that depend on the context."""

from dataclasses import dataclass
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.objectives import reconstruction_error
from latentarm.models.scn import runtime
from latentarm.models.scn.runtime import UNITS


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SCN(NeuralModel):
    """State-conditioned nonlinear decoder ``phi(z, c) = W_2(c) tanh(W_1(c) z)``.

    After Przystupa et al., Investigating the Benefits of Nonlinear Action Maps in Data-Driven Teleoperation
    (2024, arXiv 2410.21406): a network of the context gives the weights, as for the linear decoder (`SCL`),
    but of a nonlinear network of z that has an odd activation and no biases. So, by construction,
    ``phi(0, c) = 0`` and ``phi(-z, c) = -phi(z, c)``. It is trained as a conditioned autoencoder, with a
    network that encodes, on ``‖a - phi(psi(c, a), c)‖^2``. Our source for the paper is its abstract and
    what reviews of it say, not its full text: one hidden layer of tanh units and their number are ours.

    The paper finds that such maps are nearly linear over most of the range of the input, and no better for
    people to drive with. Its other proposal, a regulariser, is `CAEReversal`.
    """

    kind: ClassVar[ModelKind] = runtime.SCN

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return reconstruction_error(batch.action, self._action(networks, latent, batch.context))

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return mlp(networks["encoder"], context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        inputs = latent.shape[-1]
        weights = mlp(networks["decoder"], context).unflatten(-1, (-1, UNITS))
        first = weights[..., :inputs, :]
        second = weights[..., inputs:, :].flatten(-2).unflatten(-1, (UNITS, -1))
        hidden = torch.tanh((latent[..., None] * first).sum(-2))
        return (hidden[..., None] * second).sum(-2)
