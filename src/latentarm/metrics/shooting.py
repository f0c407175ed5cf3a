"""An operator who plans: how near latent actions can bring the tool, all of them chosen together.

The greedy operator of `latentarm.metrics.approach` looks one step ahead and can lead itself into a dead end,
for which the decoder is not to blame. Here z is constant over pieces of half a second, the state is integrated
at the data's own step, and the pieces of a whole drive are bettered together (direct shooting): at the moment
at which the tool is nearest to its goal, the Jacobian of its place with respect to all pieces comes out of one
pass through the decoder in torch, and a damped Gauss-Newton step follows, with z held inside [-1, 1].

Each drive begins from what the greedy operator did and from near rest. Nothing is taken over that is not
better, so that what is reported is never worse than greedy. It is still an upper bound on what the latent
space allows, but a tighter one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
import torch
from torch import Tensor

from latentarm.kinematics.chain import Chain
from latentarm.kinematics.torch_chain import TorchChain
from latentarm.metrics.approach import SolverConfig, Target, approach, tool_places
from latentarm.metrics.contract import DecodesActions
from latentarm.metrics.samples import StartGoalPairs
from latentarm.types import FloatArray

NEAR_REST: Final = 0.05
"""Every latent action of the second start: exactly at rest, decoders of z's length have no gradient."""

FIRST_DAMPING: Final = 1e-2
LEAST_DAMPING: Final = 1e-4
GROWTH: Final = 10.0
"""The damping is relative to the largest curvature; after a step that did not help it grows by this, after one
that did it shrinks."""


class DecodesInTorch(Protocol):
    """One decoder, differentiable, in two steps as `latentarm.models.torch_decoder.TorchDecoder`."""

    @property
    def observe(self) -> "_Observes":
        """What is seen of contexts (..., c)."""
        ...

    def decode(self, z: Tensor, observed: Tensor) -> Tensor:
        """Joint velocities (..., m) of z (..., d) in what was observed, rad/s."""
        ...


class _Observes(Protocol):
    def __call__(self, context: Tensor, /) -> Tensor: ...


@dataclass(frozen=True)
class ShootingConfig:
    """How much is planned.

    Attributes:
        time_s: time in which to get there; the nearest moment counts, s.
        piece_s: how long each latent action is held, s.
        iterations: Gauss-Newton steps.
    """

    time_s: float = 6.0
    piece_s: float = 0.5
    iterations: int = 12


def planned_reach(
    decoders: Sequence[DecodesActions],
    differentiable: Sequence[DecodesInTorch],
    pairs: StartGoalPairs,
    chain: Chain,
    step_s: float,
    config: ShootingConfig,
    tool: int = 0,
) -> FloatArray:
    """Least distance of the tool from its place at the goal, of a plan or of the greedy operator.

    Args:
        decoders: S decoders.
        differentiable: the same in torch.
        pairs: P start-goal pairs.
        chain: the robot.
        step_s: dt of the transition, s.
        config: how much is planned.
        tool: which end-effector.

    Returns:
        (S, P), m.
    """
    target = Target(tool_places(chain, pairs.goal, (tool,)), pairs.goal)
    greedy = approach(
        decoders, pairs.start, target, chain, step_s, SolverConfig(time_s=config.time_s), (tool,)
    )
    return np.stack(
        [
            np.minimum(distance, _plan(decoder, latent, pairs, chain, step_s, config, tool))
            for decoder, latent, distance in zip(differentiable, greedy.latent, greedy.distance_m, strict=True)
        ]
    )


@dataclass(frozen=True)
class _Drives:
    """B drives of one decoder: how to roll them out.

    Attributes:
        decoder: the decoder.
        tools: the place of the tool.
        start: (B, c), contexts.
        goal: (B, 3), m.
        held: steps for which each piece is held.
        step_s: dt, s.
    """

    decoder: DecodesInTorch
    tools: TorchChain
    start: Tensor
    goal: Tensor
    held: int
    step_s: float

    def nearest(self, z: Tensor) -> tuple[Tensor, Tensor]:
        """Offset (B, 3), m, from the goal where z (B, K, d) brings the tool nearest, and d(offset)/dz.

        Every drive is rolled out three times side by side, once for each coordinate of the offset: that is
        the whole Jacobian (B, 3, K d) in one pass back.
        """
        drives = len(z)
        pieces = z.detach().repeat(3, 1, 1).requires_grad_()
        context = self.start.repeat(3, 1)
        states: list[Tensor] = []
        for piece in range(pieces.shape[1]):
            for _ in range(self.held):
                action = self.decoder.decode(pieces[:, piece], self.decoder.observe(context))
                dof = action.shape[-1]
                state = context[:, :dof] + self.step_s * action
                context = torch.cat([state, context[:, dof:]], dim=-1)
                states.append(state)
        place: Tensor = self.tools(torch.stack(states))[0]
        offset = place.unflatten(1, (3, drives)) - self.goal
        distance = torch.linalg.vector_norm(offset.detach()[:, 0], dim=-1)
        # Far from its data a decoder may overflow: such a moment is never the nearest.
        at = torch.where(torch.isfinite(distance), distance, torch.inf).argmin(dim=0)
        at_nearest = offset[at, :, torch.arange(drives)]  # (B, 3 copies, 3)
        (slope,) = torch.autograd.grad(at_nearest.diagonal(dim1=1, dim2=2).sum(), pieces)
        jacobian = slope.unflatten(0, (3, drives)).flatten(2).transpose(0, 1)
        return at_nearest.detach()[:, 0], torch.nan_to_num(jacobian)


def _plan(
    decoder: DecodesInTorch,
    greedy: FloatArray,
    pairs: StartGoalPairs,
    chain: Chain,
    step_s: float,
    config: ShootingConfig,
    tool: int,
) -> FloatArray:
    """Least distance (P,), m, of drives that begin as the greedy latents (P, T, d) and near rest."""
    held = max(1, round(config.piece_s / step_s))
    pieces = greedy.shape[1] // held
    first = greedy[:, : pieces * held].reshape(len(greedy), pieces, held, -1).mean(axis=2)
    z = torch.from_numpy(np.concatenate([first, np.full_like(first, NEAR_REST)])).float()
    drives = _Drives(
        decoder=decoder,
        tools=TorchChain(chain, tool).float(),
        start=torch.from_numpy(pairs.start).float().repeat(2, 1),
        goal=torch.from_numpy(chain.forward(pairs.goal, tool).position).float().repeat(2, 1),
        held=held,
        step_s=step_s,
    )
    return _bettered(drives, z, config.iterations).reshape(2, -1).min(axis=0)


def _bettered(drives: _Drives, z: Tensor, iterations: int) -> FloatArray:
    """Distance (B,), m, after damped Gauss-Newton steps from z (B, K, d)."""
    offset, jacobian = drives.nearest(z)
    distance = torch.linalg.vector_norm(offset, dim=-1)
    damping = torch.full_like(distance, FIRST_DAMPING)
    for _ in range(iterations):
        tried = (z + _step(z, offset, jacobian, damping)).clamp(-1.0, 1.0)
        new_offset, new_jacobian = drives.nearest(tried)
        new_distance = torch.linalg.vector_norm(new_offset, dim=-1)
        better = new_distance < distance
        z = torch.where(better[:, None, None], tried, z)
        offset = torch.where(better[:, None], new_offset, offset)
        jacobian = torch.where(better[:, None, None], new_jacobian, jacobian)
        distance = torch.where(better, new_distance, distance)
        damping = torch.where(better, (damping / GROWTH).clamp_min(LEAST_DAMPING), damping * GROWTH)
    return distance.numpy().astype(np.float64)


def _step(z: Tensor, offset: Tensor, jacobian: Tensor, damping: Tensor) -> Tensor:
    """Change of z (B, K, d) by which the offset (B, 3) would go, as far as the Jacobian (B, 3, K d) tells."""
    flat = z.flatten(1)
    gradient = (jacobian * offset[..., None]).sum(dim=1)
    # What would be pushed out of the box stays where it is.
    held = ((flat >= 1.0) & (gradient < 0)) | ((flat <= -1.0) & (gradient > 0))
    free = torch.where(held[:, None], 0.0, jacobian)
    gram = free @ free.mT
    ridge = damping * gram.diagonal(dim1=1, dim2=2).sum(dim=-1) + torch.finfo(z.dtype).tiny
    solved = torch.linalg.solve(gram + ridge[:, None, None] * torch.eye(3), offset[..., None])
    return -(free.mT @ solved).reshape(z.shape)
