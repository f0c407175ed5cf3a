"""Training latent actions to keep every goal reachable: the entropy over goals of equations 15 and 16."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.term import LossTerm, TermContexts
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

Where = Literal["demonstrated", "any_belief", "anywhere"]


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
class GoalEntropy(LossTerm):
    """``lambda_2 Σ_g p_c(g) log p_c(g)`` (equation 16): in every context, some input for each goal.

    Contexts are those in which a person may want to turn back, not only the demonstrated ones:
    between any two demonstrated states, with any demonstrated belief. The term needs no actions there.

    Raises:
        UserError: a parameter is out of its range.
    """

    goals: FloatArray  # (G, n), configurations, rad
    weight: float = 2.0  # lambda_2
    sharpness: float = 4.0  # kappa of `log_probabilities`
    least_progress: float = 0.5  # rho_0 of `log_probabilities`, of the demonstrated speed
    per_axis: int = 7  # evenly spaced inputs in [-1, 1] on each axis, over which z is summed
    where: Where = "anywhere"
    """``demonstrated`` contexts, their states with ``any_belief``, or ``anywhere`` between these states."""
    chain: Chain | None = None  # for progress of the tool; without it the joints alone count

    def __post_init__(self) -> None:
        if self.goals.ndim != 2 or len(self.goals) < 2 or not np.isfinite(self.goals).all():
            raise UserError("An entropy over goals needs two goals or more, each a finite configuration.")
        if not (math.isfinite(self.weight) and self.weight >= 0):
            raise UserError(f"The weight of the entropy must be zero or more, not {self.weight}.")
        if not (math.isfinite(self.sharpness) and self.sharpness > 0):
            raise UserError(f"The sharpness of the entropy must be positive, not {self.sharpness}.")
        if not self.least_progress < math.inf:
            raise UserError(f"The least progress must be a number or -inf, not {self.least_progress}.")
        if self.per_axis < 2:
            raise UserError(f"The entropy needs at least 2 inputs on each axis, not {self.per_axis}.")

    def contexts(self, demonstrated: FloatArray, joints: int, rng: np.random.Generator) -> FloatArray:
        """Contexts (CONTEXTS, c) as ``where`` says; see `LossTerm.contexts`."""
        one, other, believing = demonstrated[rng.integers(0, len(demonstrated), (3, CONTEXTS))]
        share = rng.uniform(size=(CONTEXTS, 1))
        state, belief = one[:, :joints], one[:, joints:]
        if self.where != "demonstrated":
            belief = believing[:, joints:]
        if self.where == "anywhere":
            state = share * state + (1 - share) * other[:, :joints]
        return np.concatenate([state, belief], axis=1)

    def __call__(self, situation: TermContexts) -> Tensor:
        """``lambda_2`` times the negative entropy, mean over contexts: (S,)."""
        state = situation.state
        goals = torch.as_tensor(self.goals, dtype=state.dtype, device=state.device)
        actions = situation.action_of(self._inputs(situation.axes))
        chain = None if self._torch_chain is None else self._torch_chain.to(state)
        progress = goal_progress(state, actions, goals, situation.speed, chain)
        log = log_probabilities(progress, self.sharpness, self.least_progress)
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


def log_probabilities(progress: Tensor, sharpness: float, least_progress: float) -> Tensor:
    """Logarithm of ``p_c(g)``: how much of a person's possible actions conveys each goal (equation 15).

    The paper leaves the score open. Here it is::

        eta(g, c, z) = exp(kappa rho_g(c, z)),    p_c(g) = Σ_z eta(g, c, z) / (Σ_g' Σ_z eta(g', c, z) + eta_0)

    with rho the progress towards g, ``eta_0 = K exp(kappa rho_0)`` for K inputs z, and kappa so large that
    the best input counts most. ``eta_0`` stands for conveying no goal: a goal counts as open where some
    input makes more progress towards it than rho_0. Without it (rho_0 = -inf; equation 15 to the letter) a
    decoder that hardly moves towards any goal has the highest entropy of all.

    ``progress`` (..., K, G) is the speed towards each goal for K inputs, and ``least_progress`` is rho_0,
    both in units of the demonstrated speed; ``sharpness`` is kappa.
    """
    score = torch.logsumexp(sharpness * progress, dim=-2)
    if not math.isfinite(least_progress):
        return torch.log_softmax(score, dim=-1)
    none = torch.full_like(score[..., :1], math.log(progress.shape[-2]) + sharpness * least_progress)
    return torch.log_softmax(torch.cat([score, none], dim=-1), dim=-1)[..., :-1]
