"""A decoder that is homogeneous: half the push moves half as fast, and the opposite push goes back."""

from dataclasses import dataclass, field
from typing import ClassVar, Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.models.batches import Batch, TrainingData
from latentarm.models.homogeneous.runtime import BEND_SIZE, DAMPING_M2, HOMOGENEOUS, ORDERS
from latentarm.models.kind import Dimensions, ModelKind
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.objectives import reconstruction_error
from latentarm.models.parameters import RANGE, Real
from latentarm.models.tool_contexts import PLACE, ToolSizes
from latentarm.models.torch_tool_contexts import applied, inner
from latentarm.types import FloatArray

STRAIGHT_START: Final = 8.0
"""Size of the first guess of M_1(c), where what an untrained network adds is about 0.5: large enough that
every seed starts with the same orientation everywhere, without a jump between M_1 and -M_1."""

BEND_START: Final = 4.0
"""The same of the bends."""

HALF_TURN: Final = 64
"""Directions that the encoder tries for d = 2, over half a turn: each stands for its opposite too."""

DIRECTIONS: Final = 128
"""Directions that it tries for d > 2."""

REFINEMENTS: Final = 2
"""Rounds of refinement of the best direction, each four times finer than the last."""


def principal_start(data: TrainingData, dimensions: Dimensions) -> dict[str, FloatArray]:
    """Begin with M_1(c) along the d principal actions everywhere, and the bends along the next ones."""
    principal = np.linalg.eigh(data.action.T @ data.action)[1].T[::-1]
    columns = np.zeros(((1 + len(ORDERS)) * dimensions.latent, dimensions.action))
    for column, direction in zip(columns, principal, strict=False):
        column[:] = BEND_START * direction
    columns[: dimensions.latent] *= STRAIGHT_START / BEND_START
    return {f"decoder.{len(dimensions.hidden)}.bias": columns.reshape(-1)}


@final
@dataclass(kw_only=True, eq=False, repr=False)
class Homogeneous(NeuralModel):
    """Homogeneous latent actions: ``phi(z, c) = v r R(c, z / r)`` with r = ‖z‖.

    ``R(c, e) = M_1(c) e + M_3(c) T_3(e) + M_5(c) T_5(e) + M_7(c) T_7(e)``, brought to unit length, with the
    odd Chebyshev polynomials T_n entry by entry. The d columns of M_1(c) are orthonormal in the metric of the
    tools ``G(s) = J^T W J + damping 1``, and those of the others metric-orthogonal to them. So, by
    construction, for every context and all weights:

    - ``phi(0, c) = 0``: rest is rest;
    - ``phi(a z, c) = a phi(z, c)`` for every number a, negative ones too: half the push moves half as fast,
      and the opposite push takes a motion back, to first order in the step;
    - ``‖phi(z, c)‖_G = v ‖z‖``: the same push moves the tools equally fast, in that metric, everywhere and
      in every direction; a full push has the demonstrations' highest speed v.

    The directions of a linear decoder lie in a plane, and an arm that has left the demonstrated motions
    finds none that leads back. These lie on a closed curve that leaves the plane (for d = 2, of the first,
    third, fifth and seventh harmonics of the stick's angle), so that there is nearly always a direction that
    brings the tools closer, and there are more kinds of motion than axes. The price is that between its axes
    the motion may turn several times as fast as the stick; `latentarm.metrics.turning`
    measures how much.

    A network of the context gives the matrices. The encoder searches for the latent action whose action is
    nearest; it has no weights. What SCL (Przystupa et al., arXiv 2410.21441) does with d fixed directions is
    the special case without bends and with the metric of the joints.

    Attributes:
        smoothness_weight: price of ``‖phi(z, c') - phi(z, c)‖^2`` between a demonstrated context and the one
            that the demonstrated action leads to within a tenth of a second: this is what the opposite push
            would not undo.
    """

    kind: ClassVar[ModelKind] = HOMOGENEOUS
    looks_ahead: ClassVar[bool] = True
    start = staticmethod(principal_start)
    smoothness_weight: float = field(default=2.0, metadata={RANGE: Real()})

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        here = _geometry(networks, batch.context, batch.action.shape[-1])
        latent = _nearest(here, batch.action)
        action = _decoded(here, latent)
        later = _decoded(_geometry(networks, batch.later, batch.action.shape[-1]), latent)
        error = reconstruction_error(batch.action, action)
        return error + self.smoothness_weight * reconstruction_error(action, later)

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return _nearest(_geometry(networks, context, action.shape[-1]), action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        joints = networks["decoder"][-1][0].shape[-1] // ((1 + len(ORDERS)) * latent.shape[-1])
        return _decoded(_geometry(networks, context, joints), latent)


class _Geometry(NamedTuple):
    """The decoder in each context.

    Attributes:
        columns: (S, B, m, (1 + orders) d), M_1(c), M_3(c), ... side by side.
        twists: (S, B, 6 k, (1 + orders) d), the tools' weighted twists along them.
    """

    columns: Tensor
    twists: Tensor

    @property
    def latent_dim(self) -> int:
        """Size of z, d."""
        return self.columns.shape[-1] // (1 + len(ORDERS))


def _geometry(networks: Networks, context: Tensor, joints: int) -> _Geometry:
    """The matrices in contexts observed by `ToolContexts`, (S, B, ...)."""
    contexts = networks["decoder"][0][0].shape[-2]
    sizes = ToolSizes(contexts, joints, (context.shape[-1] - contexts) // (PLACE + 2 * 6 * joints))
    jacobian = context[..., sizes.jacobian].unflatten(-1, (sizes.twists, joints))
    columns = mlp(networks["decoder"], context[..., :contexts]).unflatten(-1, (-1, joints)).mT
    twists = jacobian @ columns
    latent = columns.shape[-1] // (1 + len(ORDERS))
    straight: list[Tensor] = []
    straight_twist: list[Tensor] = []
    bend, bend_twist = BEND_SIZE * columns[..., latent:], BEND_SIZE * twists[..., latent:]
    for axis in range(latent):
        column, twist = columns[..., axis], twists[..., axis]
        for other, other_twist in zip(straight, straight_twist, strict=True):
            along = inner(column, twist, other, other_twist, DAMPING_M2)
            column, twist = column - along * other, twist - along * other_twist
        size = (inner(column, twist, column, twist, DAMPING_M2) + NORM_FLOOR).rsqrt()
        column, twist = column * size, twist * size
        along = (twist[..., None] * bend_twist).sum(-2, keepdim=True)
        along = along + DAMPING_M2 * (column[..., None] * bend).sum(-2, keepdim=True)
        bend, bend_twist = bend - column[..., None] * along, bend_twist - twist[..., None] * along
        straight.append(column)
        straight_twist.append(twist)
    return _Geometry(
        torch.cat([torch.stack(straight, dim=-1), bend], dim=-1),
        torch.cat([torch.stack(straight_twist, dim=-1), bend_twist], dim=-1),
    )


def _odd_degrees(direction: Tensor) -> Tensor:
    """As `latentarm.models.homogeneous.runtime.odd_degrees`, in torch."""
    twice = 4 * direction.square() - 2
    before, degree, parts = direction, direction, [direction]
    for _ in ORDERS:
        before, degree = degree, twice * degree - before
        parts.append(degree)
    return torch.cat(parts, dim=-1)


def _decoded(geometry: _Geometry, latent: Tensor) -> Tensor:
    """Phi of latents (S, B, d): (S, B, m)."""
    radius = torch.linalg.vector_norm(latent, dim=-1, keepdim=True)
    degrees = _odd_degrees(latent / radius.clamp_min(NORM_FLOOR))
    led, twist = applied(geometry.columns, degrees), applied(geometry.twists, degrees)
    return radius * led * (inner(led, twist, led, twist, DAMPING_M2) + NORM_FLOOR).rsqrt()


@torch.no_grad()
def _nearest(geometry: _Geometry, action: Tensor) -> Tensor:
    """The latents (S, B, d) whose actions are nearest to ``action`` (S, B, m).

    The best push in a given direction has a closed form, so only the direction is searched for: over a fixed
    set, then around the best of it along each axis with parabolas. That is exact for d = 1 and otherwise an
    approximation.
    No gradient flows through the search: at a minimum over z the loss does not change with z, so its gradient
    with respect to the weights is that at fixed z (the envelope theorem).
    """
    fixed = _directions(geometry.latent_dim).to(action)
    spacing = np.pi / HALF_TURN

    def explained(direction: Tensor) -> Tensor:
        """How much of ‖a‖^2 the best push explains, (S, B, K), in directions (K, d) or (S, B, K, d)."""
        led = geometry.columns @ _odd_degrees(direction).mT
        along = (led * action[..., None]).sum(-2)
        return along.square() / (led.square().sum(-2) + NORM_FLOOR)

    best = fixed[explained(fixed).argmax(-1)]
    for _ in range(REFINEMENTS if geometry.latent_dim > 1 else 0):
        for axis in range(geometry.latent_dim):
            towards = torch.zeros_like(best)
            towards[..., axis] = 1.0
            # Along the sphere; zero where the direction is the axis itself.
            tangent = _unit(towards - best[..., axis, None] * best)
            tried = torch.stack([_unit(best + shift * spacing * tangent) for shift in (-1, 0, 1)], dim=-2)
            less, here, more = explained(tried).unbind(-1)
            curvature = 2 * here - less - more
            vertex = torch.where(curvature > 0, 0.5 * (more - less) / curvature.clamp_min(NORM_FLOOR), 0.0)
            best = _unit(best + (spacing * vertex.clamp(-1, 1))[..., None] * tangent)
        spacing /= 4
    degrees = _odd_degrees(best)
    led, twist = applied(geometry.columns, degrees), applied(geometry.twists, degrees)
    size = (inner(led, twist, led, twist, DAMPING_M2) + NORM_FLOOR).sqrt()
    push = (led * action).sum(-1, keepdim=True) * size / (led.square().sum(-1, keepdim=True) + NORM_FLOOR)
    return push * best


def _unit(vectors: Tensor) -> Tensor:
    """Vectors (..., d) brought to length 1; those that are nearly zero become zero."""
    length = torch.linalg.vector_norm(vectors, dim=-1, keepdim=True)
    return torch.where(length > 1e-6, vectors / length.clamp_min(NORM_FLOOR), torch.zeros_like(vectors))


def _directions(latent_dim: int) -> Tensor:
    """Unit vectors (K, d), spread over half of all directions."""
    if latent_dim == 1:
        return torch.ones(1, 1)
    if latent_dim == 2:
        angle = torch.arange(HALF_TURN) * (np.pi / HALF_TURN)
        return torch.stack([angle.cos(), angle.sin()], dim=-1)
    drawn = np.random.default_rng(0).normal(size=(DIRECTIONS, latent_dim))
    axes = np.concatenate([np.eye(latent_dim), drawn / np.linalg.norm(drawn, axis=-1, keepdims=True)])
    return torch.from_numpy(axes)
