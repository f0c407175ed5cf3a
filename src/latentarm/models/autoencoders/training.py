"""Training of AE (equation 6 of the paper), VAE (7), cAE and cVAE (8), and of these two with a penalty."""

from abc import ABC
from dataclasses import dataclass
from typing import ClassVar, final

import torch
from torch import Tensor

from latentarm.models.autoencoders import runtime
from latentarm.models.batches import Batch
from latentarm.models.kind import ModelKind
from latentarm.models.losses import kl_divergence, reconstruction_error, sample_latent
from latentarm.models.networks import Networks, mlp, mlp_along
from latentarm.models.neural import NeuralModel
from latentarm.models.parameters import NotNegative


class _Autoencoder(NeuralModel, ABC):
    """A network that encodes and a network that decodes."""

    def _encoded(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        """The encoder network on (c, a): (S, B, c) and (S, B, m) to (S, B, d), or 2 d for a Gaussian one."""
        return mlp(networks["encoder"], context, action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return mlp(networks["decoder"], *((latent, context) if self.kind.sees_context else (latent,)))


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

    kl_weight: NotNegative = 0.01

    def _drawn(self, networks: Networks, batch: Batch) -> tuple[Tensor, Tensor]:
        """Latent actions (S, B, d) drawn from the encoder, and the price of their distribution, (S,)."""
        mean, log_variance = self._encoded(networks, batch.context, batch.action).chunk(2, dim=-1)
        divergence = self.kl_weight * kl_divergence(mean, log_variance)
        return sample_latent(mean, log_variance, batch.noise), divergence

    def _bound(self, networks: Networks, batch: Batch) -> Tensor:
        latent, divergence = self._drawn(networks, batch)
        return divergence + reconstruction_error(batch.action, self._action(networks, latent, batch.context))

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
    """

    kind: ClassVar[ModelKind] = runtime.CAE_ZERO
    zero_weight: NotNegative = 1.0  # lambda_0

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = batch.action.new_zeros(*batch.action.shape[:2], self.latent_dim)
        at_rest = self._action(networks, latent, batch.context)
        error = self._error(networks, batch)
        return error + self.zero_weight * reconstruction_error(torch.zeros_like(at_rest), at_rest)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class VAE(_Variational):
    """Variational autoencoder: ``‖a - phi(z)‖^2 + lambda KL[N(mu, sigma) ‖ N(0, 1)]`` (equation 7).

    ``kl_weight`` is lambda: below 1, as in the paper, to keep the latent space from collapsing.
    """

    kind: ClassVar[ModelKind] = runtime.VAE

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        return self._bound(networks, batch)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CVAE(_Variational):
    """Conditioned variational autoencoder (equation 8): ``‖a - phi(z, c)‖^2 + lambda KL``, as in `VAE`."""

    kind: ClassVar[ModelKind] = runtime.CVAE

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        return self._bound(networks, batch)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAEReversal(_Deterministic):
    """cAE with a penalty on motion that the opposite input does not undo.

    ``‖a - phi(z, c)‖^2 + lambda_r ‖phi(z, c) + phi(-z, c)‖^2``: the penalty is zero where phi is odd in z. Of
    the two ways to an odd decoder in Przystupa et al. (2024, arXiv 2410.21406) this is the soft one, a
    regulariser on an end-to-end decoder. Our source for the paper is its abstract and reviews of it, so
    the form of the penalty is ours.
    """

    kind: ClassVar[ModelKind] = runtime.CAE_REVERSAL
    reversal_weight: NotNegative = 1.0  # lambda_r

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        both = torch.cat([batch.context, batch.context], dim=1)
        action, back = self._action(networks, torch.cat([latent, -latent], dim=1), both).chunk(2, dim=1)
        error = reconstruction_error(batch.action, action)
        return error + self.reversal_weight * reconstruction_error(action, -back)


def _smooth_error(networks: Networks, latent: Tensor, batch: Batch, weight: float) -> Tensor:
    """``‖a - phi(z, c)‖^2 + lambda_J ‖d phi / d s‖_F^2``, (S,); the norm is estimated.

    Each pair is asked for one column of the Jacobian, in turn by its place in the batch: over the shuffles
    of training, the mean of its square times n is the squared Frobenius norm. This is the estimator of
    Hoffman et al. (Robust Learning with Jacobian Regularization, 2019, arXiv 1908.02729) with axes of the
    input for its random directions of the output.
    """
    pairs, joints = batch.action.shape[1:]
    seen = torch.cat([latent, batch.context], dim=-1)
    along = torch.zeros_like(seen)
    rows = torch.arange(pairs, device=seen.device)
    along[:, rows, latent.shape[-1] + rows % joints] = 1.0
    action, slope = mlp_along(networks["decoder"], seen, along)
    change = joints * slope.square().sum(dim=(1, 2)) / pairs
    return reconstruction_error(batch.action, action) + weight * change


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CAEJacobian(_Deterministic):
    """cAE with a penalty on how fast the decoder changes with the state.

    ``‖a - phi(z, c)‖^2 + lambda_J ‖d phi(z, c) / d s‖_F^2``, both in normalised units. The same push then
    means nearly the same motion nearby: consistency. It also covers the part of reversal that comes from
    the change of phi along a motion, in all directions and not only the demonstrated one; the part that
    comes from phi being uneven in z remains. A penalty on d phi / d z would say nothing: the encoder
    can make z larger and the derivative smaller at no cost. The contractive autoencoder (Rifai et al.,
    ICML 2011) penalises the encoder's Jacobian instead, which a person never uses.
    """

    kind: ClassVar[ModelKind] = runtime.CAE_JACOBIAN
    jacobian_weight: NotNegative = 0.1  # lambda_J

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent = self._latent(networks, batch.context, batch.action)
        return _smooth_error(networks, latent, batch, self.jacobian_weight)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CVAEJacobian(_Variational):
    """cVAE with the penalty of `CAEJacobian`: ``‖a - phi‖^2 + lambda KL + lambda_J ‖d phi / d s‖_F^2``."""

    kind: ClassVar[ModelKind] = runtime.CVAE_JACOBIAN
    jacobian_weight: NotNegative = 0.1  # lambda_J

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        latent, divergence = self._drawn(networks, batch)
        return divergence + _smooth_error(networks, latent, batch, self.jacobian_weight)
