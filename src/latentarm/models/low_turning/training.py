"""Training of homogeneous latent actions with a price on turning."""

from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar, Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.models.batches import Batch
from latentarm.models.homogeneous.directions import nearest_direction, odd_degrees
from latentarm.models.homogeneous.training import principal_start
from latentarm.models.kind import ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.low_turning.runtime import DAMPING_M2, LOW_TURNING, ORDERS, bend_sizes
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.parameters import Count, NotNegative
from latentarm.models.tool_contexts import PLACE, TWIST, ToolSizes

HALF_TURN: Final = 18
"""Steps of the stick over half a turn at which turning is priced: 10 degrees each, as it is measured."""

PRICED: Final = 8
"""Of every so many pairs, one has its directions priced: the two prices are means over contexts."""

LEAST_CHORD: Final = 1e-3
"""Below it the length of a step is rounded off, so that its gradient is finite where nothing turns."""

LEAST_SPREAD: Final = 1e-3
"""Added to the spread along each axis, as a share of the squared speed of a full push."""


@final
@dataclass(kw_only=True, eq=False, repr=False)
class LowTurning(NeuralModel):
    """Homogeneous latent actions whose directions turn little more than the stick does.

    The decoder is that of `latentarm.models.homogeneous`, with its laws: rest, proportion and reversal by
    construction, and equal speed in the metric of the tools. Only M_1 and the bends are orthogonal as joint
    velocities, not in that metric, because turning is measured in the joints.

    The directions lie on a closed curve on the unit sphere that passes through the opposite of each of its
    points. Once around it is at least 2 pi long, and its length over 2 pi is how many times as fast as the
    stick the motion turns on average. A longer curve passes nearer to any action, demonstrated or not, so
    the error alone asks for length. Here training

    - charges for length (``turning_weight``), over all contexts together: a context in which the
      demonstrations go more ways than a plane has keeps its bends, and others straighten;
    - charges for velocities of the tool that lie in a plane (``spread_weight``). A short curve can leave out
      one direction of space, and an arm that must go there zigzags: with ``W(c)`` the mean of ``v v^T`` over
      the curve, v the velocity of the tool's place in units of a full push, the price is
      ``-log det (W + epsilon 1)``;
    - shows the network contexts with noise (``context_noise``), the demonstrated action unchanged, which
      makes it smooth between and around demonstrations (Bishop, 1995: noise on inputs is a penalty on
      slopes).
    """

    kind: ClassVar[ModelKind] = LOW_TURNING
    looks_ahead: ClassVar[bool] = True
    jitters: ClassVar[bool] = True
    start = staticmethod(principal_start)
    epochs: Count = 15
    smoothness_weight: NotNegative = 2.0  # as in `latentarm.models.homogeneous`
    turning_weight: NotNegative = 0.05  # price of the mean turn of the joints' motion per turn of the stick
    spread_weight: NotNegative = 0.01  # price of ``-log det (W + epsilon 1)``, mean over tools
    # SD of the noise, in units of each context entry's spread over the demonstrations
    context_noise: NotNegative = 0.4

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        joints, pairs = batch.action.shape[-1], batch.action.shape[1]
        shift = self.context_noise * batch.noise
        both = torch.cat([_shifted(batch.context, shift), _shifted(batch.later, shift)], dim=1)
        here, later = _curves(networks, both, joints).split(pairs)
        latent = _nearest(here, batch.action)
        action = _decoded(here, latent)
        around = _around(here)
        return (
            reconstruction_error(batch.action, action)
            + self.smoothness_weight * reconstruction_error(action, _decoded(later, latent))
            + self.turning_weight * turning(around)
            + self.spread_weight * narrowness(around)
        )

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return _nearest(_curves(networks, context, action.shape[-1]), action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        joints = networks["decoder"][-1][0].shape[-1] // ((1 + len(ORDERS)) * latent.shape[-1])
        return _decoded(_curves(networks, context, joints), latent)


class _Curves(NamedTuple):
    """Curves of directions in B contexts, which come last: many small matrices are fast only so."""

    columns: Tensor  # (S, q, m, B), M_1(c), M_3(c), ... side by side; q = (1 + orders) d.
    jacobian: Tensor  # (S, 6 k, m, B), from joint velocities to the tools' weighted twists

    def split(self, pairs: int) -> "tuple[_Curves, _Curves]":
        """The first B contexts and the others."""
        return (
            _Curves(self.columns[..., :pairs], self.jacobian[..., :pairs]),
            _Curves(self.columns[..., pairs:], self.jacobian[..., pairs:]),
        )

    @property
    def latent_dim(self) -> int:
        """Size of z, d."""
        return self.columns.shape[1] // (1 + len(ORDERS))

    def led(self, direction: Tensor) -> tuple[Tensor, Tensor]:
        """Joint velocities (S, m, B), of any length, along directions (S, d, B); the tools' speeds."""
        led = (self.columns * odd_degrees(direction)[:, :, None]).sum(1)
        twist = (self.jacobian * led[:, None]).sum(2)
        size = twist.square().sum(1, keepdim=True) + DAMPING_M2 * led.square().sum(1, keepdim=True)
        return led, (size + NORM_FLOOR).sqrt()


def _curves(networks: Networks, context: Tensor, joints: int) -> _Curves:
    """The curves in contexts (S, B, o) observed by `ToolContexts`."""
    contexts = networks["decoder"][0][0].shape[-2]
    sizes = ToolSizes(contexts, joints, (context.shape[-1] - contexts) // (PLACE + 2 * TWIST * joints))
    raw = mlp(networks["decoder"], context[..., :contexts]).mT.contiguous().unflatten(1, (-1, joints))
    latent_dim = raw.shape[1] // (1 + len(ORDERS))
    first, bend = raw.split([latent_dim, raw.shape[1] - latent_dim], dim=1)
    bend = torch.as_tensor(bend_sizes(latent_dim)).to(raw)[:, None, None] * bend
    straight: list[Tensor] = []
    for raw_column in first.split(1, dim=1):
        column = raw_column
        for other in straight:
            column = column - (column * other).sum(2, keepdim=True) * other
        column = column * (column.square().sum(2, keepdim=True) + NORM_FLOOR).rsqrt()
        bend = bend - (column * bend).sum(2, keepdim=True) * column
        straight.append(column)
    jacobian = context[..., sizes.jacobian].mT.contiguous().unflatten(1, (sizes.twists, joints))
    return _Curves(torch.cat([*straight, bend], dim=1), jacobian)


def _decoded(curves: _Curves, latent: Tensor) -> Tensor:
    """Phi of latents (S, B, d): (S, B, m)."""
    pushed = latent.mT
    radius = torch.linalg.vector_norm(pushed, dim=1, keepdim=True)
    led, speed = curves.led(pushed / radius.clamp_min(NORM_FLOOR))
    return (radius / speed * led).mT


@torch.no_grad()
def _nearest(curves: _Curves, action: Tensor) -> Tensor:
    """The latents (S, B, d) whose actions are nearest to ``action`` (S, B, m).

    No gradient flows through the search: at a minimum over z the loss does not change with z, so its gradient
    with respect to the weights is that at fixed z (the envelope theorem).
    """
    target = action.mT
    best = nearest_direction(curves.columns, target, curves.latent_dim)
    led, speed = curves.led(best)
    push = (led * target).sum(1, keepdim=True) * speed / (led.square().sum(1, keepdim=True) + NORM_FLOOR)
    return (push * best).mT


class Around(NamedTuple):
    """The motions of a full push that is led half around the stick, in some of a batch's contexts.

    C planes of two of the d axes have K + 1 directions each, from one to its opposite.
    """

    joints: Tensor  # (S, m, C, K + 1, B), the joints' velocities, of any length
    tools: Tensor  # (S, 6 k, C, K + 1, B), the tools' weighted twists, as shares of a full push's speed


def turning(around: Around) -> Tensor:
    """Mean turn of the joints' motion per turn of the stick, (S,): 1 for directions in a plane.

    Counted in chords, which are shorter than arcs by 0.1 % at 10 degrees.
    """
    unit = around.joints * (around.joints.square().sum(1, keepdim=True) + NORM_FLOOR).rsqrt()
    chord = (unit.diff(dim=3).square().sum(1) + LEAST_CHORD**2).sqrt()
    return chord.mean(dim=(1, 2, 3)) * (chord.shape[2] / np.pi)


def narrowness(around: Around) -> Tensor:
    """``-log det (W + epsilon 1)``, mean over tools and contexts, (S,): 3 log 3 where W is isotropic."""
    twist = around.tools.unflatten(1, (-1, TWIST))
    velocity = twist[:, :, :3, :, :-1].flatten(3, 4)  # (S, k, 3, C K, B)
    spread = torch.einsum("stikb,stjkb->stbij", velocity, velocity) / velocity.shape[3]
    # Where there are k tools, each has 1 / k of the squared speed.
    spread = twist.shape[1] * spread + LEAST_SPREAD * torch.eye(3, dtype=spread.dtype, device=spread.device)
    first, second, third = spread.unbind(-2)
    volume = (first * torch.linalg.cross(second, third)).sum(-1)
    return -volume.log().mean(dim=(1, 2))


def _shifted(context: Tensor, shift: Tensor) -> Tensor:
    """Observations (S, B, o) whose first c entries, which the network sees, are moved by (S, B, c)."""
    seen, geometry = context.split([shift.shape[-1], context.shape[-1] - shift.shape[-1]], dim=-1)
    return torch.cat([seen + shift, geometry], dim=-1)


def _around(here: _Curves) -> Around:
    circles = _half_circles(here.latent_dim).to(here.columns)
    degrees = odd_degrees(circles.permute(2, 0, 1)[None])[0]  # (q, C, K + 1)
    joints = torch.einsum("sqmb,qck->smckb", here.columns[..., ::PRICED], degrees)
    twist = torch.einsum("swmb,smckb->swckb", here.jacobian[..., ::PRICED], joints)
    size = twist.square().sum(1, keepdim=True) + DAMPING_M2 * joints.square().sum(1, keepdim=True)
    return Around(joints, twist * (size + NORM_FLOOR).rsqrt())


def _half_circles(latent_dim: int) -> Tensor:
    """Unit vectors (C, K + 1, d) over half a turn in each of the C planes of two axes; for d = 1 the axis."""
    if latent_dim == 1:
        return torch.ones(1, 2, 1)
    angle = torch.arange(HALF_TURN + 1) * (np.pi / HALF_TURN)
    axes = torch.eye(latent_dim)
    planes = [
        angle.cos()[:, None] * axes[first] + angle.sin()[:, None] * axes[second]
        for first, second in combinations(range(latent_dim), 2)
    ]
    return torch.stack(planes)
