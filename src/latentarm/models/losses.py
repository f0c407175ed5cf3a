"""The parts of the models' loss functions, one value per seed."""

import torch
from torch import Tensor


def reconstruction_error(action: Tensor, reconstructed: Tensor) -> Tensor:
    """``‖a - a_h‖^2`` (S,) of equations 6-8, mean over a batch of normalised actions (S, B, m)."""
    squared = torch.nn.functional.mse_loss(reconstructed, action, reduction="none")
    return squared.sum(dim=(1, 2)) / action.shape[1]


def kl_divergence(mean: Tensor, log_variance: Tensor) -> Tensor:
    """``KL[N(mu, sigma) ‖ N(0, 1)]`` (S,) of equations 7 and 8, summed over d, mean over the batch.

    Closed form per dimension: ``(mu^2 + sigma^2 - log sigma^2 - 1) / 2``, with mu and log sigma^2 (S, B, d).
    """
    per_entry = mean.square() + log_variance.exp() - log_variance - 1
    return per_entry.sum(dim=(1, 2)) / (2 * mean.shape[1])


def sample_latent(mean: Tensor, log_variance: Tensor, noise: Tensor) -> Tensor:
    """Latent actions drawn from N(mu, sigma) with standard normal ``noise``: (S, B, d)."""
    return torch.addcmul(mean, (0.5 * log_variance).exp(), noise)
