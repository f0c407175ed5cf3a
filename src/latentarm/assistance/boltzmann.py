"""Belief for a Boltzmann-rational person in joint space: the likelihood of section 8.2."""

from collections.abc import Sequence
from typing import Unpack, final

import numpy as np

from latentarm.assistance.belief import Belief, BeliefOptions, log_choice, not_negative
from latentarm.core.types import FloatArray


@final
class BoltzmannBelief(Belief):
    """A person who approximately chooses what brings the arm closest to the goal after the look-ahead tau.

    ::

        P(u | s, g) = exp(-beta D(g, s + a_h(u) tau)) / Σ_{u' in U} exp(-beta D(g, s + a_h(u') tau))
        D(g, s)     = ‖g - s‖²

    ``U`` is `alternatives`. A zero input is no evidence. The distance is squared, as in the person's
    reward in section 8.2, for a reason: what tells two goals apart is then only the motion along the line
    between them, so that someone who has arrived and stabs or scoops, which leads away from every
    goal alike, does not seem to have changed their mind.

    Args:
        beta: rationality, 1/rad²; 0 learns nothing.
        horizon_s: the look-ahead tau, s.

    Raises:
        UserError: a parameter is not finite or out of its range.
    """

    def __init__(
        self,
        goals: FloatArray | Sequence[FloatArray],
        beta: float = 20.0,
        horizon_s: float = 0.5,
        **options: Unpack[BeliefOptions],
    ) -> None:
        super().__init__(goals, horizon_s, **options)
        self.beta = not_negative("beta", beta)

    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        # D(g, s + a tau) - D(g, s) = ‖a tau‖² - 2 a tau · (g - s): a product of matrices for all goals at
        # once, and D(g, s) itself cancels.
        way = self.horizon_s * actions
        away = self.goals - state[..., None, :]
        distance = np.vecdot(way, way)[..., None] - 2.0 * (way @ away.mT)
        return log_choice(self.beta * (distance[..., :1, :] - distance))
