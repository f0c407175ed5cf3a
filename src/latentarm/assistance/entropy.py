"""Latent actions that leave every goal open: the entropy of equations 15 and 16, for training."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
import torch
from torch import Tensor

from latentarm.models.term import Decode, LossTerm, Units
from latentarm.types import FloatArray


@final
@dataclass(frozen=True, eq=False)
class GoalEntropy(LossTerm):
    goals: FloatArray
    weight: float = 1.0
    sharpness: float = 4.0
    least: float = 0.5
    samples: int = 7
    near_rad: float = 0.1
    spread: str = "mixed"

    @property
    def settings(self) -> Mapping[str, object]:
        return {"weight": self.weight}

    def contexts(self, demonstrated: FloatArray, joints: int, rng: np.random.Generator) -> FloatArray:
        rows = rng.integers(0, len(demonstrated), (3, 4000))
        share = rng.uniform(0, 1, (4000, 1))
        first, second, third = demonstrated[rows]
        if self.spread == "demonstrated":
            return first
        if self.spread == "shuffled":
            return np.concatenate([first[:, :joints], third[:, joints:]], 1)
        return np.concatenate([share * first[:, :joints] + (1 - share) * second[:, :joints], third[:, joints:]], 1)

    def __call__(self, decode: Decode, context: Tensor, centre: Tensor, scale: Tensor, units: Units) -> Tensor:
        n = units.joints
        seeds, rows, _ = context.shape
        u = torch.linspace(-1, 1, self.samples)
        latent_dim = centre.shape[-1]
        grid = torch.cartesian_prod(*[u] * latent_dim).reshape(-1, latent_dim)
        z = centre + scale * grid  # (S, K, d)
        count = len(grid)
        latent = z[:, :, None].expand(seeds, count, rows, latent_dim).reshape(seeds, -1, latent_dim)
        repeated = context[:, None].expand(seeds, count, rows, context.shape[-1]).reshape(seeds, count * rows, -1)
        action = decode(latent, repeated).unflatten(1, (count, rows)) * torch.as_tensor(units.action_scale, dtype=context.dtype)
        state = context[..., :n] * torch.as_tensor(units.context_scale[:n], dtype=context.dtype) + torch.as_tensor(
            units.context_centre[:n], dtype=context.dtype
        )
        away = torch.as_tensor(self.goals, dtype=context.dtype) - state[:, :, None]  # S,B,G,n
        direction = away / torch.linalg.vector_norm(away, dim=-1, keepdim=True).clamp_min(self.near_rad)
        progress = torch.einsum("skbn,sbgn->skbg", action, direction) / units.speed
        score = torch.logsumexp(self.sharpness * progress, dim=1) - np.log(count)  # S,B,G
        if np.isfinite(self.least):
            none = torch.full_like(score[..., :1], self.sharpness * self.least)
            log_p = torch.log_softmax(torch.cat([score, none], -1), -1)[..., :-1]
        else:
            log_p = torch.log_softmax(score, -1)
        negative_entropy = (log_p.exp() * log_p).sum(-1).mean(-1)
        return self.weight * negative_entropy
