"""cAE that is told to rest when the input rests."""

from dataclasses import dataclass
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.networks import Networks
from latentarm.models.neural import NeuralModel, conditioned_action, encoder_output
from latentarm.models.objectives import reconstruction_error


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAEZero(NeuralModel):
    """cAE with a penalty on motion at zero input: ``‖a - phi(z, c)‖^2 + lambda_0 ‖phi(0, c)‖^2``.

    The cAE alone is free to keep moving when the stick is let go; the penalty asks for rest there in
    every demonstrated context.

    Attributes:
        zero_weight: lambda_0.
    """

    kind: ClassVar[str] = "cae_zero"
    rests_at_zero: ClassVar[bool] = True
    zero_weight: float = 1.0

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        error = reconstruction_error(batch.action, self._action(networks, latent, batch.context))
        at_rest = self._action(networks, torch.zeros_like(latent), batch.context)
        return error + self.zero_weight * reconstruction_error(torch.zeros_like(at_rest), at_rest)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return encoder_output(networks, context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return conditioned_action(networks, latent, context)
