"""The paper's own help: the action towards the goals (equation 3), blended with the person's (equation 2)."""

import math
from functools import partial
from typing import Self, final

import numpy as np

from latentarm.assistance.assistance import Assistance, AssistanceRule, Contribution
from latentarm.assistance.blending import Arbitration, assistive_action
from latentarm.core.types import FloatArray


@final
class GoalBlending(Assistance):
    """``a = (1 - alpha) a_h + alpha Σ_g b(g) (g - s)`` (equation 10), with goals (G, n), rad."""

    def __init__(self, goals: FloatArray, arbitration: Arbitration) -> None:
        self._goals = goals
        self._arbitration = arbitration

    @property
    def acts_at_rest(self) -> bool:
        return self._arbitration.acts_at_rest

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """Equation 3, as much as the arbitration says."""
        alpha = float(self._arbitration.alpha(u, belief))
        return Contribution(assistive_action(state, belief, self._goals), alpha)

    def over(self, goals: FloatArray) -> Self:
        return type(self)(goals, self._arbitration)

    def bound_rad(self, given: Contribution, state: FloatArray, belief: FloatArray, sigma_h: float) -> float:
        """Equation 14 for one moment: delta over the belief in the goal."""
        probabilities = belief.tolist()
        sure = max(probabilities)
        away = self._goals - state
        distance = np.vecdot(away, away).tolist()
        distance[probabilities.index(sure)] = 0.0
        delta = (1.0 - given.alpha) / given.alpha * sigma_h + (1.0 - sure) * math.sqrt(max(distance))
        return delta / sure if math.isfinite(delta) else math.nan


def blending(arbitration: Arbitration) -> AssistanceRule:
    """The rule of `GoalBlending` with an arbitration."""
    return partial(GoalBlending, arbitration=arbitration)
