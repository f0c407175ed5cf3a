"""A decoder that is an isometry: the tools move as far as the input is pushed, everywhere."""

from dataclasses import dataclass
from typing import ClassVar, Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.batches import Batch, TrainingData
from latentarm.models.isometric.runtime import BEND_SIZE, DAMPING_M2, ISOMETRIC
from latentarm.models.kind import Dimensions, ModelKind
from latentarm.models.losses import reconstruction_error
from latentarm.models.networks import Networks, mlp
from latentarm.models.neural import NeuralModel
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.parameters import NotNegative
from latentarm.models.tool_contexts import PLACE, TWIST, ToolSizes
from latentarm.models.torch_tool_contexts import applied, inner

STRAIGHT_START: Final = 2.0
"""Size of the first guess of M(c), where what an untrained network adds is about 0.5: large enough that every
seed starts with the same orientation everywhere. M and -M reconstruct equally well, and a network that chose
between them at random in different places would keep a jump between the two that training cannot remove."""

SATURATION_START: Final = 1.0  # first guess of kappa, before softplus
RADII: Final = 10  # values of ‖z‖ that the encoder tries before it refines the best
REFINEMENTS: Final = 3  # rounds of refinement, each six times finer than the one before
LEAST_RADIUS: Final = 1e-4
MOST_RADIUS: Final = 1.5
"""The encoder's smallest and largest ‖z‖; the fastest hundredth of the demonstrations lies beyond 1."""


def principal_start(data: TrainingData, dimensions: Dimensions) -> dict[str, FloatArray]:
    """Begin with M(c) along the tools' d principal twists everywhere, and the bend along the next d."""
    sizes = ToolSizes(dimensions.context, dimensions.action, dimensions.tools)
    jacobian = data.context[:, sizes.jacobian].reshape(-1, sizes.twists, sizes.joints)
    twist = np.einsum("nij,nj->ni", jacobian, data.action)
    principal = np.linalg.eigh(twist.T @ twist)[1].T[::-1]
    columns = np.zeros((2, dimensions.latent, sizes.twists))
    for column, direction in zip(columns.reshape(-1, sizes.twists), principal, strict=False):
        column[:] = direction
    columns[0] *= STRAIGHT_START
    return {
        f"decoder.{len(dimensions.hidden)}.bias": columns.reshape(-1),
        "gain.0.weight": np.zeros(1),
        "gain.0.bias": np.array([SATURATION_START]),
    }


@final
@dataclass(kw_only=True, eq=False, repr=False)
class Isometric(NeuralModel):
    """Isometric latent actions: ``phi(z, c) = g(r) R(c, r) z / r`` with r = ‖z‖.

    ``R(c, r) = M(c) + (2 min(r, 1) - 1) N(c)``, brought to unit length: d directions M(c), orthonormal in
    the metric of the tools ``G(s) = J^T W J + damping 1``, and a bend N(c), metric-orthogonal to them, by
    which a harder push may lead elsewhere than a soft one. So, by construction, for every context and all
    weights:

    - ``phi(0, c) = 0``: rest is rest;
    - ``phi(-z, c) = -phi(z, c)``: the opposite input takes a motion back, to first order in the step;
    - ``‖phi(z, c)‖_G = g(‖z‖)``: the same push moves the tools equally fast, in that metric, everywhere and
      in every direction, and a harder push faster. ``g(r) = v tanh(kappa r) / tanh(kappa)``: a full push
      has the demonstrations' highest speed v, and kappa is learned, near zero (a straight line) unless the
      demonstrations ask for more;
    - where the bend is zero, the axes are orthogonal in that metric, which counts turns and joint speeds a
      little: they move the tools nearly at right angles.

    The bend lets d inputs serve demonstrations that differ in more than d ways (a fan of directions at one
    speed); ``bend_weight`` prices it, so that it stays near zero where M(c) alone will do. The networks
    output twists of the tools, mapped to the joints by the damped pseudo-inverse ``G^-1 J^T W``, plus joint
    speeds, which also cover motion that no tool shows. The encoder searches for the latent
    action whose action is nearest; it has no weights. All of this builds on the state-conditioned linear
    decoder (Przystupa et al., arXiv 2410.21441).
    """

    kind: ClassVar[ModelKind] = ISOMETRIC
    start = staticmethod(principal_start)
    # Price of the bend, as the tools show it, and of kappa, per unit of their squares
    bend_weight: NotNegative = 1e-3

    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        gain = _gain(networks)
        geometry = _geometry(networks, batch.context, self.latent_dim)
        latent = _nearest(geometry, gain, batch.action)
        error = reconstruction_error(batch.action, _decoded(geometry, gain, latent))
        bend = geometry.bend_twist.square().sum(dim=(1, 2, 3)) / batch.action.shape[1]
        return error + self.bend_weight * (bend + gain.saturation.square()[:, 0, 0])

    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        return _nearest(_geometry(networks, context, self.latent_dim), _gain(networks), action)

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return _decoded(_geometry(networks, context, self.latent_dim), _gain(networks), latent)


class _Gain(NamedTuple):
    """Speed of the tools for a push of r, in normalised units: ``g(r) = tanh(kappa r) / tanh(kappa)``."""

    saturation: Tensor  # (S, 1, 1), kappa

    def at(self, radius: Tensor) -> Tensor:
        """g(r) for radii (S, B, ...)."""
        return torch.tanh(self.saturation * radius) / torch.tanh(self.saturation)


class _Geometry(NamedTuple):
    """The decoder in each context."""

    straight: Tensor  # (S, B, m, d), M(c), orthonormal in the metric
    bend: Tensor  # (S, B, m, d), N(c), metric-orthogonal to M(c)
    bend_twist: Tensor  # (S, B, 6 k, d), the tools' weighted twists along the bend


def _gain(networks: Networks) -> _Gain:
    ((weight, bias),) = networks["gain"]
    return _Gain(torch.nn.functional.softplus(weight + bias))


def _geometry(networks: Networks, context: Tensor, latent_dim: int) -> _Geometry:
    """M, N and the twists along N in contexts observed by `ToolContexts`, (S, B, ...)."""
    twists = networks["decoder"][-1][0].shape[-1] // (2 * latent_dim)
    joints = networks["posture"][-1][0].shape[-1] // (2 * latent_dim)
    tools = twists // TWIST
    sizes = ToolSizes(networks["decoder"][0][0].shape[-2] - PLACE * tools, joints, tools)
    seen = context[..., : sizes.seen]
    jacobian = context[..., sizes.jacobian].unflatten(-1, (twists, joints))
    lift = context[..., sizes.lift].unflatten(-1, (joints, twists))
    twist = mlp(networks["decoder"], seen).unflatten(-1, (2 * latent_dim, twists))
    posture = mlp(networks["posture"], seen).unflatten(-1, (2 * latent_dim, joints))
    columns = lift @ twist.mT + posture.mT
    column_twist = jacobian @ columns
    straight, straight_twist = _orthonormal(columns[..., :latent_dim], column_twist[..., :latent_dim])
    bend, bend_twist = BEND_SIZE * columns[..., latent_dim:], BEND_SIZE * column_twist[..., latent_dim:]
    along = _gram(straight_twist, bend_twist) + DAMPING_M2 * _gram(straight, bend)
    for axis in range(latent_dim):
        part = along[..., axis, None, :]
        bend = bend - straight[..., axis, None] * part
        bend_twist = bend_twist - straight_twist[..., axis, None] * part
    return _Geometry(straight, bend, bend_twist)


def _gram(first: Tensor, second: Tensor) -> Tensor:
    """``A^T B`` of (..., k, d) and (..., k, e): element by element, since they are small and many."""
    return (first[..., :, None] * second[..., None, :]).sum(-3)


def _orthonormal(columns: Tensor, twists: Tensor) -> tuple[Tensor, Tensor]:
    """Gram-Schmidt in the metric over columns (S, B, m, d) and their weighted twists (S, B, 6 k, d)."""
    done: list[Tensor] = []
    done_twist: list[Tensor] = []
    for raw, raw_twist in zip(columns.unbind(-1), twists.unbind(-1), strict=True):
        column, twist = raw, raw_twist
        for other, other_twist in zip(done, done_twist, strict=True):
            along = inner(column, twist, other, other_twist, DAMPING_M2)
            column, twist = column - along * other, twist - along * other_twist
        size = (inner(column, twist, column, twist, DAMPING_M2) + NORM_FLOOR).rsqrt()
        done.append(column * size)
        done_twist.append(twist * size)
    return torch.stack(done, dim=-1), torch.stack(done_twist, dim=-1)


def _decoded(geometry: _Geometry, gain: _Gain, latent: Tensor) -> Tensor:
    """Phi of latents (S, B, d): (S, B, m)."""
    radius = torch.linalg.vector_norm(latent, dim=-1, keepdim=True)
    direction = latent / radius.clamp_min(NORM_FLOOR)
    turn = _turn(radius)
    bend, bend_twist = applied(geometry.bend, direction), applied(geometry.bend_twist, direction)
    bend_size = inner(bend, bend_twist, bend, bend_twist, DAMPING_M2)
    led = applied(geometry.straight, direction) + turn * bend
    return gain.at(radius) * led * (1 + turn.square() * bend_size).rsqrt()


def _turn(radius: Tensor) -> Tensor:
    """How much of the bend counts at a radius: from -1 at rest to 1 at full push and beyond."""
    return 2 * radius.clamp_max(1) - 1


@torch.no_grad()
def _nearest(geometry: _Geometry, gain: _Gain, action: Tensor) -> Tensor:
    """The latents (S, B, d) whose actions are nearest to ``action`` (S, B, m).

    The direction follows from least squares, so only the radius is searched for: over a grid, then around its
    best with parabolas. That is exact for d = 1, and for d > 1 where nothing bends and the best radius
    is below `MOST_RADIUS`; otherwise it is an approximation. No gradient flows
    through the search: at a minimum over z the loss does not change with z, so its gradient with respect
    to the weights is that at fixed z (the envelope theorem).
    """
    straight, bend, bend_twist = geometry
    overlap, cross, spread = _gram(straight, straight), _gram(straight, bend), _gram(bend, bend)
    bend_metric = _entries(_gram(bend_twist, bend_twist) + DAMPING_M2 * spread)
    overlap, cross, spread = _entries(overlap), _entries(cross + cross.mT), _entries(spread)
    on_straight, on_bend = applied(straight.mT, action)[..., None], applied(bend.mT, action)[..., None]
    axes = range(len(overlap))

    def fit(radius: Tensor) -> tuple[Tensor, list[Tensor]]:
        """Error, less ‖a‖^2, (S, B, K) and the d entries of the best directions for radii (S, B, K)."""
        turn = _turn(radius)
        target = [on_straight[..., axis, :] + turn * on_bend[..., axis, :] for axis in axes]
        gram = [[overlap[i][j] + turn * (cross[i][j] + turn * spread[i][j]) for j in axes] for i in axes]
        direction = _direction(gram, target)
        reach = gain.at(radius) * (1 + turn.square() * _quadratic(bend_metric, direction)).rsqrt()
        along = torch.stack([u * v for u, v in zip(direction, target, strict=True)]).sum(0)
        return reach.square() * _quadratic(gram, direction) - 2 * reach * along, direction

    # Finer near rest: for a slow action even a small radius can be several times too large.
    share = torch.arange(1, RADII + 1, dtype=action.dtype, device=action.device) / RADII
    grid, spacing = MOST_RADIUS * share.square(), 2 * MOST_RADIUS / RADII * share
    chosen = fit(grid.expand(*action.shape[:-1], RADII))[0].argmin(-1, keepdim=True)
    best, step = grid[chosen], spacing[chosen]
    around = torch.linspace(-1, 1, 5, dtype=action.dtype, device=action.device)
    for _ in range(REFINEMENTS):
        radii = (best + step * around).clamp(LEAST_RADIUS, MOST_RADIUS)
        error = fit(radii)[0]
        middle = error.argmin(-1, keepdim=True).clamp(1, 3)
        before, here, after = (error.gather(-1, middle + shift) for shift in (-1, 0, 1))
        curvature = before - 2 * here + after
        vertex = torch.where(curvature > 0, 0.5 * (before - after) / curvature.clamp_min(NORM_FLOOR), 0.0)
        best = (radii.gather(-1, middle) + vertex.clamp(-1, 1) * step / 2).clamp(LEAST_RADIUS, MOST_RADIUS)
        step = step / 6
    return best * torch.cat(fit(best)[1], dim=-1)


Entries = list[list[Tensor]]
"""Matrices (S, B, K, d, d), entry by entry: they are small and many, and torch is slow at such."""


def _entries(matrices: Tensor) -> Entries:
    """Matrices (S, B, d, d) entry by entry, each (S, B, 1)."""
    return [[entry[..., None] for entry in row.unbind(-1)] for row in matrices.unbind(-2)]


def _quadratic(matrix: Entries, vector: list[Tensor]) -> Tensor:
    """``v^T A v``, (S, B, K)."""
    terms = [matrix[i][j] * (vector[i] * vector[j]) for i in range(len(vector)) for j in range(len(vector))]
    return torch.stack(terms).sum(0) if len(terms) > 1 else terms[0]


def _direction(gram: Entries, target: list[Tensor]) -> list[Tensor]:
    """Unit vectors along ``gram^-1 target``, by elimination."""
    if len(target) == 1:
        return [torch.where(target[0] < 0, -1.0, 1.0).to(target[0].dtype)]
    rows = [[*row, value] for row, value in zip(gram, target, strict=True)]
    for pivot in range(len(rows)):
        scale = rows[pivot][pivot].clamp_min(NORM_FLOOR)
        rows[pivot] = [entry / scale for entry in rows[pivot]]
        for row in range(len(rows)):
            if row != pivot:
                factor = rows[row][pivot]
                pairs = zip(rows[row], rows[pivot], strict=True)
                rows[row] = [entry - factor * above for entry, above in pairs]
    solution = [row[-1] for row in rows]
    size = torch.stack(solution).square().sum(0).sqrt().clamp_min(NORM_FLOOR)
    return [entry / size for entry in solution]
