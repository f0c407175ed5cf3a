"""Priors on any control (equations 20 to 22), and the supervised loss (equation 19).

Each is a mean over the second axis, (S,), of squared lengths of poses, m^2 (see `pose_vectors`), so that they
can be summed (equation 23).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import torch
from torch import Tensor

if TYPE_CHECKING:
    from latentarm_research.alignment.transition import Push


@final
@dataclass(frozen=True)
class Priors:
    """Weight of each prior relative to the answers (equation 23); without units."""

    proportional: float = 1.0  # lambda_1
    reversible: float = 1.0  # lambda_2
    consistent: float = 0.2  # lambda_3. Lower, since the same input need not do quite the same elsewhere
    gamma: float = 1.0  # how fast consistency fades with the distance of two states, 1/rad


NO_PRIORS: Final = Priors(proportional=0.0, reversible=0.0, consistent=0.0)
"""Learning from answers alone (equation 19)."""


def supervised(
    push: "Push",  # (S, N), the answers' inputs
    wanted: Tensor,  # (S, N, p), the poses at the motions' ends
) -> Tensor:
    """``‖x* - Psi(T(s, u))‖^2`` (equation 19): the input of an answer leads where the shown motion led."""
    return _squared(push.pose - wanted).mean(-1)


def proportional(
    push: "Push",  # (S, B), inputs u
    part: "Push",  # (S, B), inputs alpha u in the same places
    alpha: Tensor,  # (S, B, 1), in [-1, 1]
) -> Tensor:
    """``‖Psi(T(alpha u, s)) - Psi(s) - alpha Δx‖^2`` (equation 20): half the push moves half as far.

    Where f is smooth in u, as a network is, only a linear one has this property for all alpha.
    """
    return _squared(part.change - alpha * push.change).mean(-1)


def reversible(
    push: "Push",  # (S, B), inputs u
    back: "Push",  # (S, B), inputs -u, from where those led
) -> Tensor:
    """``‖Psi(s) - Psi(T(-u, T(u, s)))‖^2`` (equation 21): the opposite push undoes a push."""
    return _squared(push.before.pose - back.pose).mean(-1)


def consistent(
    push: "Push",  # (S, B), inputs u in places s_1
    elsewhere: "Push",  # (S, B), the same inputs in other places s_2
    gamma: float,  # 1/rad
    joints: int,
) -> Tensor:
    """``‖Δx(s_1) - Δx(s_2)‖^2 exp(-gamma ‖s_1 - s_2‖)`` (equation 22): the same push moves alike nearby.

    Equation 22 compares how far the tool moves; this compares where to as well, and squares what it compares
    like the other terms.
    """
    apart = (push.before.context - elsewhere.before.context)[..., :joints]
    weight = torch.exp(-gamma * torch.linalg.vector_norm(apart, dim=-1))
    return (weight * _squared(push.change - elsewhere.change)).mean(-1)


def _squared(vectors: Tensor) -> Tensor:
    return vectors.square().sum(-1)
