"""A decoder that is homogeneous: half the push moves half as fast, and the opposite push goes back."""

from dataclasses import dataclass
from typing import ClassVar, Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.batches import Batch, TrainingData
from latentarm.models.homogeneous.directions import nearest_direction, odd_degrees
from latentarm.models.homogeneous.runtime import BEND_SIZE, DAMPING_M2, HOMOGENEOUS, ORDERS
from latentarm.models.kind import Dimensions, ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.parameters import NotNegative
from latentarm.models.tool_contexts import PLACE, ToolSizes

STRAIGHT_START: Final = 8.0
"""Size of the first guess of M_1(c), where what an untrained network adds is about 0.5: large enough that
every seed starts with the same orientation everywhere, without a jump between M_1 and -M_1."""

BEND_START: Final = 4.0  # the same of the bends


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
    the motion may turn several times as fast as the stick; `latentarm.evaluation.turning`
    measures how much.

    A network of the context gives the matrices. The encoder searches for the latent action whose action is
    nearest; it has no weights. What SCL (Przystupa et al., arXiv 2410.21441) does with d fixed directions is
    the special case without bends and with the metric of the joints.
    """

    kind: ClassVar[ModelKind] = HOMOGENEOUS
    looks_ahead: ClassVar[bool] = True
    start = staticmethod(principal_start)
    # Price of ``‖phi(z, c') - phi(z, c)‖^2`` between a demonstrated context and the one that the demonstrated
    # action leads to within a tenth of a second: this is what the opposite push would not undo
    smoothness_weight: NotNegative = 2.0

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
    """The decoder in each context, with the B pairs last: arithmetic on many small matrices is fast only so.

    Each column comes twice: as joint velocities, and in coordinates in which the metric is the identity,
    ``(J_w a, sqrt(damping) a)``, of w = 6 k + m entries.
    """

    straight: list[Tensor]  # d of (S, m, B), the orthonormal columns of M_1(c)
    straight_white: list[Tensor]  # d of (S, w, B), the same in those coordinates
    bend: Tensor  # (S, orders d, m, B), the network's M_3(c), M_5(c), ...
    bend_white: Tensor  # (S, orders d, w, B)
    along: list[Tensor]  # d of (S, orders d, B), parts of the bends along straight columns, to be removed

    def led(self, degrees: Tensor) -> tuple[Tensor, Tensor]:
        """The columns weighted with `odd_degrees` (S, q, B) of directions, added: (S, m, B), (S, w, B)."""
        first, bent = degrees.split([len(self.straight), self.bend.shape[1]], dim=1)
        bent = BEND_SIZE * bent
        action, white = (self.bend * bent[:, :, None]).sum(1), (self.bend_white * bent[:, :, None]).sum(1)
        columns = list(zip(self.straight, self.straight_white, strict=True))
        # First what the bends share with the straight columns: added to the entry, rounding would lose it.
        for column, column_white in columns:
            share = (column_white * white).sum(1, keepdim=True)
            action, white = action - share * column, white - share * column_white
        for (column, column_white), entry in zip(columns, first.split(1, dim=1), strict=True):
            action, white = action + entry * column, white + entry * column_white
        return action, white

    def columns(self) -> Tensor:
        """M_1(c), M_3(c), ... side by side, (S, q, m, B)."""
        bend = self.bend
        for column, along in zip(self.straight, self.along, strict=True):
            bend = bend - along[:, :, None] * column[:, None]
        return torch.cat([torch.stack(self.straight, dim=1), BEND_SIZE * bend], dim=1)


def _geometry(networks: Networks, context: Tensor, joints: int) -> _Geometry:
    """The matrices in contexts (S, B, ...) observed by `ToolContexts`."""
    contexts = networks["decoder"][0][0].shape[-2]
    sizes = ToolSizes(contexts, joints, (context.shape[-1] - contexts) // (PLACE + 2 * 6 * joints))
    raw = mlp(networks["decoder"], context[..., :contexts])
    latent = raw.shape[-1] // joints // (1 + len(ORDERS))
    jacobian = context[..., sizes.jacobian].unflatten(-1, (sizes.twists, joints))
    damping = np.sqrt(DAMPING_M2) * torch.eye(joints, dtype=raw.dtype, device=raw.device)
    whiten = torch.cat([jacobian.mT, damping.expand(*raw.shape[:2], -1, -1)], dim=-1)
    white = (raw.unflatten(-1, (-1, joints)) @ whiten).flatten(-2)
    parts = [latent, latent * len(ORDERS)]
    first, bend = _pairs_last(raw, joints).split(parts, dim=1)
    first_white, bend_white = _pairs_last(white, whiten.shape[-1]).split(parts, dim=1)
    straight: list[Tensor] = []
    straight_white: list[Tensor] = []
    for column, column_white in zip(first.unbind(1), first_white.unbind(1), strict=True):
        for other, other_white in zip(straight, straight_white, strict=True):
            overlap = (column_white * other_white).sum(1, keepdim=True)
            column, column_white = column - overlap * other, column_white - overlap * other_white
        size = (column_white.square().sum(1, keepdim=True) + NORM_FLOOR).rsqrt()
        straight.append(size * column)
        straight_white.append(size * column_white)
    along = [(column[:, None] * bend_white).sum(2) for column in straight_white]
    return _Geometry(straight, straight_white, bend, bend_white, along)


def _pairs_last(rows: Tensor, width: int) -> Tensor:
    """(S, B, q width) to (S, q, width, B)."""
    return rows.mT.contiguous().unflatten(1, (-1, width))


def _decoded(geometry: _Geometry, latent: Tensor) -> Tensor:
    """Phi of latents (S, B, d): (S, B, m)."""
    pushed = latent.mT
    radius = torch.linalg.vector_norm(pushed, dim=1, keepdim=True)
    action, white = geometry.led(odd_degrees(pushed / radius.clamp_min(NORM_FLOOR)))
    return (radius * (white.square().sum(1, keepdim=True) + NORM_FLOOR).rsqrt() * action).mT


@torch.no_grad()
def _nearest(geometry: _Geometry, action: Tensor) -> Tensor:
    """The latents (S, B, d) whose actions are nearest to ``action`` (S, B, m).

    The best push in a given direction has a closed form, so only the direction is searched for.
    No gradient flows through the search: at a minimum over z the loss does not change with z, so its gradient
    with respect to the weights is that at fixed z (the envelope theorem).
    """
    target = action.mT
    best = nearest_direction(geometry.columns(), target, len(geometry.straight))
    led, white = geometry.led(odd_degrees(best))
    size = (white.square().sum(1, keepdim=True) + NORM_FLOOR).sqrt()
    push = (led * target).sum(1, keepdim=True) * size / (led.square().sum(1, keepdim=True) + NORM_FLOOR)
    return (push * best).mT
