"""Training of AE (equation 6 of the paper), VAE (7), cAE and cVAE (8), and of cAE with a penalty."""

from abc import ABC
from dataclasses import dataclass, field
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.autoencoders import runtime
from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.objectives import kl_divergence, reconstruction_error, sample_latent
from latentarm.models.parameters import RANGE, Real


class _Autoencoder(NeuralModel, ABC):
    """A network that encodes and a network that decodes."""

    def _encoded(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        """The encoder network on (c, a): (S, B, c) and (S, B, m) to (S, B, d), or 2 d for a Gaussian one."""
        return mlp(networks["encoder"], torch.cat([context, action], dim=-1))

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        seen = torch.cat([latent, context], dim=-1) if self.kind.sees_context else latent
        return mlp(networks["decoder"], seen)


class _Deterministic(_Autoencoder, ABC):
    """``‖a - phi(psi(c, a), c)‖^2``."""

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return self._encoded(networks, context, action)

    def _error(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return reconstruction_error(batch.action, self._action(networks, latent, batch.context))


@dataclass(kw_only=True, eq=False, repr=False)
class _Variational(_Autoencoder, ABC):
    """``‖a - phi(z, c)‖^2 + lambda KL[N(mu, sigma) ‖ N(0, 1)]``, z drawn from N(mu, sigma) of the encoder."""

    kl_weight: float = field(default=0.01, metadata={RANGE: Real()})

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        mean, log_variance = self._encoded(networks, batch.context, batch.action).chunk(2, dim=-1)
        latent = sample_latent(mean, log_variance, batch.noise)
        error = reconstruction_error(batch.action, self._action(networks, latent, batch.context))
        return error + self.kl_weight * kl_divergence(mean, log_variance)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return self._encoded(networks, context, action).chunk(2, dim=-1)[0]


@final
@dataclass(kw_only=True, eq=False, repr=False)
class AE(_Deterministic):
    """Autoencoder: minimises ``‖a - phi(psi(c, a))‖^2`` (equation 6)."""

    kind: ClassVar[ModelKind] = runtime.AE

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        return self._error(networks, batch)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAE(_Deterministic):
    """Conditioned autoencoder: ``‖a - phi(z, c)‖^2`` (equation 8 with lambda = 0)."""

    kind: ClassVar[ModelKind] = runtime.CAE

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        return self._error(networks, batch)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAEZero(_Deterministic):
    """cAE with a penalty on motion at zero input: ``‖a - phi(z, c)‖^2 + lambda_0 ‖phi(0, c)‖^2``.

    The cAE alone may keep moving when the stick is released; the penalty discourages that in every
    demonstrated context.

    Attributes:
        zero_weight: lambda_0.
    """

    kind: ClassVar[ModelKind] = runtime.CAE_ZERO
    zero_weight: float = field(default=1.0, metadata={RANGE: Real()})

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = batch.action.new_zeros(*batch.action.shape[:2], self.latent_dim)
        at_rest = self._action(networks, latent, batch.context)
        error = self._error(networks, batch)
        return error + self.zero_weight * reconstruction_error(torch.zeros_like(at_rest), at_rest)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class VAE(_Variational):
    """Variational autoencoder: ``‖a - phi(z)‖^2 + lambda KL[N(mu, sigma) ‖ N(0, 1)]`` (equation 7).

    Attributes:
        kl_weight: lambda. Below 1, as in the paper, to keep the latent space from collapsing.
    """

    kind: ClassVar[ModelKind] = runtime.VAE


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CVAE(_Variational):
    """Conditioned variational autoencoder (equation 8): ``‖a - phi(z, c)‖^2 + lambda KL``.

    Attributes:
        kl_weight: lambda. Below 1, as in the paper, to keep the latent space from collapsing.
    """

    kind: ClassVar[ModelKind] = runtime.CVAE
