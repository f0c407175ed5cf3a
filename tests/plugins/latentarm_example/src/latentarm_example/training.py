"""How the model is trained. latentarm imports this, and torch with it, for training alone."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm_example.model import STRAIGHT


@dataclass(kw_only=True, eq=False, repr=False)
class Straight(NeuralModel):
    """An autoencoder with a linear decoder that does not see the context."""

    kind: ClassVar[ModelKind] = STRAIGHT

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return reconstruction_error(batch.action, self._action(networks, latent, batch.context))

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return mlp(networks["encoder"], torch.cat([context, action], dim=-1))

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return mlp(networks["decoder"], latent)
