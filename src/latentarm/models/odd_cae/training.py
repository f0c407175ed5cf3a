"""A conditioned autoencoder whose decoder is odd: rest is rest, and the opposite push goes back."""

from dataclasses import dataclass
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.odd_cae.runtime import ODD_CAE
from latentarm.models.parameters import NotNegative


@final
@dataclass(kw_only=True, eq=False, repr=False)
class OddCAE(NeuralModel):
    """Odd cAE: ``phi(z, c) = (f(z, c) - f(-z, c)) / 2``, f a network of (z, c) as in the cAE.

    Every function that is odd in z is of this form, so the decoder gives up nothing else of what the cAE
    can express. By construction, for every context and all weights:

    - ``phi(0, c) = 0``: rest is rest;
    - ``phi(-z, c) = -phi(z, c)``: the opposite input takes a motion back, to first order in the step.

    Half a push need not move half as fast. What the opposite push would not undo is the change of
    phi along the motion, which the loss charges for::

        ‖a - phi(z, c)‖^2 + lambda_s ‖phi(z, c') - phi(z, c)‖^2,    z = psi(c, a)

    with c' the context that the demonstrated action leads to within a tenth of a second, as for the
    homogeneous model. Przystupa et al. (arXiv 2410.21406) propose decoders that are odd in the action for the
    same reason; their construction is another one.
    """

    kind: ClassVar[ModelKind] = ODD_CAE
    looks_ahead: ClassVar[bool] = True
    smoothness_weight: NotNegative = 2.0  # lambda_s

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        both = torch.cat([batch.context, batch.later], dim=1)
        action, later = self._action(networks, torch.cat([latent, latent], dim=1), both).chunk(2, dim=1)
        error = reconstruction_error(batch.action, action)
        return error + self.smoothness_weight * reconstruction_error(action, later)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return mlp(networks["encoder"], context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        forth, back = torch.cat([latent, context], dim=-1), torch.cat([-latent, context], dim=-1)
        ahead, opposite = mlp(networks["decoder"], torch.cat([forth, back], dim=1)).chunk(2, dim=1)
        return 0.5 * (ahead - opposite)
