"""The paper's autoencoders: AE (equation 6), VAE (7), cAE and cVAE (8).

In all four the encoder psi(c, a) sees context and action; conditioning is about the decoder alone.
"""

from dataclasses import dataclass
from typing import ClassVar, final

from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel, conditioned_action, encoder_output, posterior
from latentarm.models.objectives import kl_divergence, reconstruction_error, sample_latent


@final
@dataclass(kw_only=True, eq=False, repr=False)
class AE(NeuralModel):
    """Autoencoder: minimises ``‖a - phi(psi(c, a))‖^2`` (equation 6)."""

    kind: ClassVar[str] = "ae"
    rests_at_zero: ClassVar[bool] = False

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return reconstruction_error(batch.action, self._action(networks, latent, batch.context))

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return encoder_output(networks, context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return mlp(networks["decoder"], latent)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class VAE(NeuralModel):
    """Variational autoencoder: ``‖a - phi(z)‖^2 + lambda KL[N(mu, sigma) ‖ N(0, 1)]`` (equation 7).

    Attributes:
        kl_weight: lambda. Below 1, as in the paper, lest the latent space collapse.
    """

    kind: ClassVar[str] = "vae"
    rests_at_zero: ClassVar[bool] = False
    kl_weight: float = 0.01

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        mean, log_variance = posterior(networks, batch.context, batch.action)
        latent = sample_latent(mean, log_variance, batch.noise)
        error = reconstruction_error(batch.action, self._action(networks, latent, batch.context))
        return error + self.kl_weight * kl_divergence(mean, log_variance)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return posterior(networks, context, action)[0]

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return mlp(networks["decoder"], latent)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAE(NeuralModel):
    """Conditioned autoencoder: ``‖a - phi(z, c)‖^2`` (equation 8 with lambda = 0)."""

    kind: ClassVar[str] = "cae"
    rests_at_zero: ClassVar[bool] = False

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return reconstruction_error(batch.action, self._action(networks, latent, batch.context))

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return encoder_output(networks, context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return conditioned_action(networks, latent, context)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CVAE(NeuralModel):
    """Conditioned variational autoencoder (equation 8): ``‖a - phi(z, c)‖^2 + lambda KL``.

    Attributes:
        kl_weight: lambda. Below 1, as in the paper, lest the latent space collapse.
    """

    kind: ClassVar[str] = "cvae"
    rests_at_zero: ClassVar[bool] = False
    kl_weight: float = 0.01

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        mean, log_variance = posterior(networks, batch.context, batch.action)
        latent = sample_latent(mean, log_variance, batch.noise)
        error = reconstruction_error(batch.action, self._action(networks, latent, batch.context))
        return error + self.kl_weight * kl_divergence(mean, log_variance)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return posterior(networks, context, action)[0]

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return conditioned_action(networks, latent, context)
