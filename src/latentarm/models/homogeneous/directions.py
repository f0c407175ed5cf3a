"""Directions of the stick in torch: their odd degrees, and the search for the one that explains an action."""

from typing import Final

import numpy as np
import torch
from torch import Tensor

from latentarm.models.homogeneous.runtime import ORDERS
from latentarm.models.numpy_networks import NORM_FLOOR

HALF_TURN: Final = 64
"""Directions that are tried for d = 2, over half a turn: each stands for its opposite too."""

DIRECTIONS: Final = 128  # directions that are tried for d > 2
REFINEMENTS: Final = 2  # rounds of refinement of the best direction, each four times finer than the last


def odd_degrees(direction: Tensor) -> Tensor:
    """As `latentarm.models.homogeneous.runtime.odd_degrees`, in torch, of directions (S, d, ...)."""
    twice = 4 * direction.square() - 2
    before, degree, parts = direction, direction, [direction]
    for _ in ORDERS:
        before, degree = degree, twice * degree - before
        parts.append(degree)
    return torch.cat(parts, dim=1)


@torch.no_grad()
def nearest_direction(columns: Tensor, target: Tensor, latent_dim: int) -> Tensor:
    """The directions of the stick (S, d, B) in which the best push comes nearest to an action (S, m, B).

    Searched for over a fixed set, then around the best of it along each axis with parabolas. That is exact
    for d = 1 and otherwise an approximation. The columns M_1(c), M_3(c), ... lie side by side, (S, q, m, B).
    """
    spacing = np.pi / HALF_TURN
    best = _best_fixed(columns, target, latent_dim)
    for _ in range(REFINEMENTS if latent_dim > 1 else 0):
        for axis in range(latent_dim):
            # Along the sphere; zero where the direction is the axis itself.
            tangent = best * -best[:, axis : axis + 1]
            tangent[:, axis] += 1.0
            tangent = _unit(tangent)
            step = spacing * tangent
            shrink = (1 + step.square().sum(1, keepdim=True)).rsqrt()
            tried = torch.stack([(best - step) * shrink, best, (best + step) * shrink], dim=2)
            less, here, more = _explained(columns, target, tried).unbind(1)
            curvature = 2 * here - less - more
            vertex = 0.5 * (more - less) / curvature.clamp_min(NORM_FLOOR)
            vertex = torch.where(curvature > 0, vertex.clamp(-1, 1), 0.0)
            best = _unit(torch.addcmul(best, vertex[:, None], step))
        spacing /= 4
    return best


def _explained(columns: Tensor, target: Tensor, direction: Tensor) -> Tensor:
    """The part (S, K, B) of ‖a‖^2 that the best push explains, along K directions (S, d, K, B)."""
    led = (columns[:, :, :, None] * odd_degrees(direction)[:, :, None]).sum(1)
    return (led * target[:, :, None]).sum(1).square() / (led.square().sum(1) + NORM_FLOOR)


def _best_fixed(columns: Tensor, target: Tensor, latent_dim: int) -> Tensor:
    """The directions (S, d, B) of `_fixed` that explain most, by ``(a^T C e)^2 / ‖C e‖^2`` of all."""
    every = torch.cat([columns, target[:, None]], dim=1).permute(0, 3, 1, 2).contiguous()
    gram = every @ every.mT
    fixed = _fixed(latent_dim).to(target)
    degrees = odd_degrees(fixed.mT[None])[0]
    products = (degrees[:, None] * degrees).flatten(0, 1)
    along = gram[..., -1, :-1] @ degrees
    size = gram[..., :-1, :-1].flatten(-2) @ products
    return fixed[(along.square() / (size + NORM_FLOOR)).max(-1).indices].mT


def _unit(vectors: Tensor) -> Tensor:
    """Vectors (S, d, B) brought to length 1; those that are nearly zero become zero."""
    length = torch.linalg.vector_norm(vectors, dim=1, keepdim=True)
    return torch.where(length > 1e-6, vectors / length.clamp_min(NORM_FLOOR), 0.0)


def _fixed(latent_dim: int) -> Tensor:
    """Unit vectors (K, d), spread over half of all directions: each stands for its opposite too."""
    if latent_dim == 1:
        return torch.ones(1, 1)
    if latent_dim == 2:
        angle = torch.arange(HALF_TURN) * (np.pi / HALF_TURN)
        return torch.stack([angle.cos(), angle.sin()], dim=-1)
    drawn = np.random.default_rng(0).normal(size=(DIRECTIONS, latent_dim))
    drawn /= np.linalg.norm(drawn, axis=-1, keepdims=True)
    return torch.from_numpy(np.concatenate([np.eye(latent_dim), drawn]))
