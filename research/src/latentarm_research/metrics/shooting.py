"""A planning operator: how close latent actions can bring the tool if all are chosen together.

The greedy operator of `latentarm.evaluation.approach` looks one step ahead and can run into a dead end
that is not the decoder's fault. Here z is constant over pieces of half a second, the state is
integrated at the data's own step, and the pieces of a whole drive are optimised together (direct shooting):
the Jacobian of where the tool ends with respect to all pieces comes out of one pass through the decoder in
torch, and a damped Gauss-Newton step towards the goal follows, with z held inside [-1, 1]. The result is the
closest moment of any drive that was tried.

Each drive begins from what the greedy operator did and from near rest, and the greedy operator's own
distance counts too, so that what is reported is never worse than greedy. It is still an upper bound on what
the latent space allows, but a tighter one. Adam needs about a hundred passes for what takes ten here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.evaluation.approach import SolverConfig, Target, approach, tool_places
from latentarm.evaluation.contract import DecodesActions
from latentarm.evaluation.samples import StartGoalPairs
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.torch_chain import TorchChain

NEAR_REST: Final = 0.05
"""Every latent action of the second start: exactly at rest, decoders of z's length have no gradient."""

FIRST_DAMPING: Final = 1e-2
LEAST_DAMPING: Final = 1e-4
GROWTH: Final = 10.0
"""The damping is relative to the largest curvature; it grows by this after a step that did not help, and
shrinks after one that did."""

CLOSE_M: Final = 1e-4  # planning ends when every goal is reached to within this, m


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
    """How much is planned."""

    time_s: float = 6.0  # time limit; the closest moment counts, s
    piece_s: float = 0.5  # how long each latent action is held, s
    iterations: int = 14  # maximum number of Gauss-Newton steps; an expensive decoder takes 4 s for these


def planned_reach(
    decoders: Sequence[DecodesActions],
    differentiable: Sequence[DecodesInTorch],  # the same in torch
    pairs: StartGoalPairs,
    chain: Chain,
    step_s: float,  # dt of the transition, s
    config: ShootingConfig,
    tool: int = 0,
) -> FloatArray:
    """Least distance of the tool from its place at the goal, of a plan or of the greedy operator.

    Returns:
        (S, P), m.
    """
    target = Target(tool_places(chain, pairs.goal, (tool,)), pairs.goal)
    greedy = approach(
        decoders, pairs.start, target, chain, step_s, SolverConfig(time_s=config.time_s), (tool,)
    )
    plans = [
        _plan(decoder, latent, pairs, chain, step_s, config, tool)
        for decoder, latent in zip(differentiable, greedy.latent, strict=True)
    ]
    return np.minimum(greedy.distance_m, np.stack(plans))


@dataclass(frozen=True)
class _Drives:
    """B drives of one decoder: how to roll them out."""

    decoder: DecodesInTorch  # the decoder
    tools: TorchChain  # the place of the tool
    start: Tensor  # (B, c), contexts
    goal: Tensor  # (B, 3), m
    held: int  # steps for which each piece is held
    step_s: float  # dt, s

    def roll_out(self, z: Tensor) -> "_Outcome":
        """Drive with z (B, K, d).

        Every drive is rolled out three times side by side, once for each coordinate of where it ends: that
        is the whole Jacobian in one pass back.
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
        offset = place.unflatten(1, (3, drives)) - self.goal  # (T, 3 copies, B, 3)
        (slope,) = torch.autograd.grad(offset[-1].diagonal(dim1=0, dim2=2).sum(), pieces)
        distance = torch.linalg.vector_norm(offset.detach()[:, 0], dim=-1)
        return _Outcome(
            # Far from its data a decoder may overflow: such a moment does not count.
            least=distance.nan_to_num(torch.inf).amin(dim=0),
            offset=offset.detach()[-1, 0],
            jacobian=slope.unflatten(0, (3, drives)).flatten(2).transpose(0, 1),
        )


@dataclass(frozen=True)
class _Outcome:
    """Results of B drives."""

    least: Tensor  # (B,), least distance of the tool from its goal, m
    offset: Tensor  # (B, 3), from the goal at the end, m
    jacobian: Tensor  # (B, 3, K d), of the offset with respect to the latent actions


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
    """Least distance (B,), m, of the drives z (B, K, d), half of them a second try, and of bettered ones."""
    came = drives.roll_out(z)
    least, offset, jacobian = came.least, came.offset, came.jacobian
    left = torch.linalg.vector_norm(offset, dim=-1)
    damping = torch.full_like(left, FIRST_DAMPING)
    for _ in range(iterations):
        if bool((least.reshape(2, -1).amin(dim=0) < CLOSE_M).all()):
            break
        tried = (z + _step(z, offset, jacobian, damping)).clamp(-1.0, 1.0)
        came = drives.roll_out(tried)
        least = torch.minimum(least, came.least)
        new_left = torch.linalg.vector_norm(came.offset, dim=-1)
        better = new_left < left
        z = torch.where(better[:, None, None], tried, z)
        offset = torch.where(better[:, None], came.offset, offset)
        jacobian = torch.where(better[:, None, None], came.jacobian, jacobian)
        left = torch.where(better, new_left, left)
        damping = torch.where(better, (damping / GROWTH).clamp_min(LEAST_DAMPING), damping * GROWTH)
    return least.numpy().astype(np.float64)


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
