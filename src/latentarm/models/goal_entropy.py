"""Training latent actions to keep every goal reachable: the entropy over goals of equations 15 and 16."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.scaling import Normaliser
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.torch_chain import TorchChain

CONTEXTS: Final = 4096  # contexts that a training draws from

NEAR_RAD: Final = 0.1
"""Nearer to a goal than this, progress towards it counts in proportion to the distance that is left: at the
goal there is no direction to it."""

NEAR_M: Final = 0.03  # the same for the tool

SLOWEST_M: Final = 0.05
"""Least speed of the tool, per unit of joint speed, that its progress is measured in: an arm that goes
straight to a goal may hardly move its tool, m/rad."""

LEAST_PROGRESS: Final = 0.5  # rho_0 of `log_probabilities`, in units of the demonstrated speed


def goal_progress(
    state: Tensor, actions: Tensor, goals: Tensor, speed: float, chain: TorchChain | None = None
) -> Tensor:
    """Progress (..., K, G) towards goals (G, n), rad, in units of the demonstrated speed, rad/s.

    Actions are (..., K, n), rad/s, in states (..., n), rad. Progress is that of the joints or, where the arm
    is known, of joints or tool, whichever is less: people see the tool (equation 24), and a redundant arm can
    bring its joints nearer to a goal while the tool goes away. The tool's is in units of the speed that it
    has when the joints go straight to the goal.
    """
    towards = _direction(goals - state[..., None, :], NEAR_RAD)
    progress = actions @ towards.mT / speed
    if chain is None:
        return progress
    with torch.no_grad():
        jacobian = chain.jacobian(state)[..., :3, :]
        away = chain(goals)[0] - chain(state)[0][..., None, :]
        straight = torch.linalg.vector_norm(towards @ jacobian.mT, dim=-1).clamp_min(SLOWEST_M)
        tool = _direction(away, NEAR_M) / straight[..., None]
    return torch.minimum(progress, (actions @ jacobian.mT) @ tool.mT / speed)


@final
@dataclass(frozen=True, eq=False)
class GoalEntropy:
    """``lambda_2 Σ_g p_c(g) log p_c(g)`` (equation 16): in every context, some input for each goal.

    Contexts are those in which a person may want to turn back, not only the demonstrated ones:
    between any two demonstrated states, with any demonstrated belief. The term needs no actions there.

    Raises:
        UserError: a parameter is out of its range.
    """

    goals: FloatArray  # (G, n), configurations, rad
    weight: float = 2.0  # lambda_2
    sharpness: float = 4.0  # kappa of `log_probabilities`
    per_axis: int = 7  # evenly spaced inputs in [-1, 1] on each axis, over which z is summed
    chain: Chain | None = None  # for progress of the tool; without it the joints alone count

    def __post_init__(self) -> None:
        if self.goals.ndim != 2 or len(self.goals) < 2 or not np.isfinite(self.goals).all():
            raise UserError("An entropy over goals needs two goals or more, each a finite configuration.")
        if not (math.isfinite(self.weight) and self.weight >= 0):
            raise UserError(f"The weight of the entropy must be zero or more, not {self.weight}.")
        if not (math.isfinite(self.sharpness) and self.sharpness > 0):
            raise UserError(f"The sharpness of the entropy must be positive, not {self.sharpness}.")
        if self.per_axis < 2:
            raise UserError(f"The entropy needs at least 2 inputs on each axis, not {self.per_axis}.")

    @property
    def settings(self) -> Mapping[str, object]:
        """Name and parameters."""
        return {
            **{name: getattr(self, name) for name in ("weight", "sharpness", "per_axis")},
            "term": "goal_entropy",
            "goals": self.goals.tolist(),
            "sees_tool": self.chain is not None,
        }

    def contexts(self, demonstrated: FloatArray, joints: int, rng: np.random.Generator) -> FloatArray:
        """Contexts (CONTEXTS, c) that training draws from, from those of the training pairs (N, c).

        The first ``joints`` entries of a context are the state, rad.
        """
        one, other, believing = demonstrated[rng.integers(0, len(demonstrated), (3, CONTEXTS))]
        share = rng.uniform(size=(CONTEXTS, 1))
        state = share * one[:, :joints] + (1 - share) * other[:, :joints]
        return np.concatenate([state, believing[:, joints:]], axis=1)

    def __call__(
        self, state: Tensor, action_of: Callable[[Tensor], Tensor], speed: float, axes: int
    ) -> Tensor:
        """``lambda_2`` times the negative entropy, mean over contexts: (S,).

        ``action_of`` maps inputs (K, d) in [-1, 1] to actions (S, E, K, m), rad/s, in states (S, E, n), rad.
        ``speed`` is the root mean square of the demonstrated ‖a‖, rad/s, and ``axes`` is d.
        """
        goals = torch.as_tensor(self.goals, dtype=state.dtype, device=state.device)
        chain = None if self._torch_chain is None else self._torch_chain.to(state)
        progress = goal_progress(state, action_of(self._inputs(axes)), goals, speed, chain)
        log = log_probabilities(progress, self.sharpness)
        return self.weight * (log.exp() * log).sum(-1).mean(-1)

    @cached_property
    def _torch_chain(self) -> TorchChain | None:
        return None if self.chain is None else TorchChain(self.chain)

    def _inputs(self, axes: int) -> Tensor:
        """Every input that is summed over, (K, d)."""
        values = torch.linspace(-1.0, 1.0, self.per_axis)
        return torch.cartesian_prod(*[values] * axes).reshape(-1, axes)


def _direction(away: Tensor, near: float) -> Tensor:
    """Unit vectors along (..., k); shorter, in proportion, where less than ``near`` is left."""
    return away / torch.linalg.vector_norm(away, dim=-1, keepdim=True).clamp_min(near)


def log_probabilities(progress: Tensor, sharpness: float) -> Tensor:
    """Logarithm of ``p_c(g)``: how much of a person's possible actions conveys each goal (equation 15).

    The paper leaves the score open. Here it is::

        eta(g, c, z) = exp(kappa rho_g(c, z)),    p_c(g) = Σ_z eta(g, c, z) / (Σ_g' Σ_z eta(g', c, z) + eta_0)

    with rho the progress towards g, ``eta_0 = K exp(kappa rho_0)`` for K inputs z, and kappa so large that
    the best input counts most. ``eta_0`` stands for conveying no goal: a goal counts as open where some
    input makes more progress towards it than rho_0. Without it (equation 15 to the letter) a decoder that
    hardly moves towards any goal has the highest entropy of all.

    ``progress`` (..., K, G) is the speed towards each goal for K inputs, in units of the demonstrated speed;
    ``sharpness`` is kappa.
    """
    score = torch.logsumexp(sharpness * progress, dim=-2)
    none = torch.full_like(score[..., :1], math.log(progress.shape[-2]) + sharpness * LEAST_PROGRESS)
    return torch.log_softmax(torch.cat([score, none], dim=-1), dim=-1)[..., :-1]


@final
@dataclass(frozen=True, eq=False)
class ScaledTerm:
    """The entropy, with the normalisers of one training."""

    term: GoalEntropy
    contexts: Normaliser  # of the first c entries of a network's input
    actions: Normaliser
    joints: int
    speed: float  # root mean square of the demonstrated ‖a‖, rad/s

    def loss(self, decode: Callable[[Tensor, Tensor], Tensor], context: Tensor, span: "Span") -> Tensor:
        """The term (S,) in contexts (S, E, c'), as the networks see them.

        ``decode`` maps latents (S, B, d) in contexts (S, B, c') to normalised actions (S, B, m).
        """

        def constant(values: FloatArray) -> Tensor:
            return torch.as_tensor(values, dtype=context.dtype, device=context.device)

        def action_of(inputs: Tensor) -> Tensor:
            latent = span.centre + span.scale * inputs.to(context)
            (seeds, contexts, width), count = context.shape, len(inputs)
            every = latent[:, None].expand(seeds, contexts, count, -1).reshape(seeds, contexts * count, -1)
            where = context[:, :, None].expand(-1, -1, count, -1).reshape(seeds, contexts * count, width)
            return decode(every, where).unflatten(1, (contexts, count)) * constant(self.actions.scale)

        joints = slice(self.joints)
        state = context[..., joints] * constant(self.contexts.scale[joints])
        state = state + constant(self.contexts.centre[joints])
        return self.term(state, action_of, self.speed, span.centre.shape[-1])


@final
@dataclass(frozen=True, eq=False)
class Span:
    """The latent actions that inputs stand for: z = centre + scale u."""

    centre: Tensor  # (S, 1, d)
    scale: Tensor  # (S, 1, d)
