"""Belief over goals from the person's inputs (equation 9)."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import final

import numpy as np

from latentarm.errors import UserError
from latentarm.types import FloatArray

ActionOf = Callable[[FloatArray], FloatArray]
"""Inputs (K, d) to the actions ``a_h`` (K, n), rad/s, that they would cause in the present state."""

_ALTERNATIVES = 8
"""How many directions a person with a 2-axis input is taken to choose between."""


@final
class BoltzmannBelief:
    """Bayes' rule over goals with a person who is Boltzmann-rational in joint space.

    Equation 9, ``b'(g) ∝ P(u | s, g) b(g)``, with the likelihood::

        P(u | s, g) = exp(-beta D(g, s + a_h(u) tau)) / Σ_{u' in U} exp(-beta D(g, s + a_h(u') tau))
        D(g, s)     = ‖g - s‖²

    ``U`` holds what the person could have given with the same effort: ``u`` turned through eight
    equal angles for a 2-axis input, ``{u, -u}`` for one axis, ``u`` and ``±‖u‖`` along every axis
    for more. A zero input is no evidence. The distance is squared, as in the person's reward in
    section 8.2, for a reason: what tells two goals apart is then only the motion along the line
    between them, so that someone who has arrived and stabs or scoops, which leads away from every
    goal alike, does not seem to have changed their mind.

    A person decides once per look-ahead ``tau``: an update every ``period_s`` counts as the share
    ``period_s / tau`` of a decision, so the belief does not depend on the rate of the loop.
    Probabilities are kept at ``floor`` or above, so that a person can always change their mind.

    Args:
        goals: (G, n), the goals' configurations, rad.
        beta: rationality, 1/rad²; 0 learns nothing.
        horizon_s: the look-ahead tau, s.
        period_s: time between updates, s.
        prior: (G,), the belief before any input; uniform where None.
        floor: smallest probability of any goal, in [0, 1/G).

    Raises:
        UserError: a parameter is not finite or out of its range.
    """

    def __init__(
        self,
        goals: FloatArray | Sequence[FloatArray],
        beta: float = 20.0,
        horizon_s: float = 0.5,
        period_s: float = 0.05,
        prior: FloatArray | None = None,
        floor: float = 0.01,
    ) -> None:
        self.goals = np.ascontiguousarray(goals, dtype=float)
        if self.goals.ndim != 2 or not self.goals.size or not np.isfinite(self.goals).all():
            raise UserError("A belief needs at least one goal, each a finite configuration in rad.")
        for name, value, positive in (
            ("beta", beta, False),
            ("horizon_s", horizon_s, True),
            ("period_s", period_s, True),
        ):
            if not np.isfinite(value) or value < 0 or (positive and value == 0):
                kind = "positive" if positive else "zero or more"
                raise UserError(f"The belief's {name} must be {kind} and finite, not {value}.")
        if not 0 <= floor < 1 / len(self.goals):
            raise UserError(f"The belief's floor must be in [0, 1/{len(self.goals)}), not {floor}.")
        self.beta = beta
        self.horizon_s = horizon_s
        self.period_s = period_s
        self.floor = floor
        self._prior = self._checked_prior(prior)

    def initial(self) -> FloatArray:
        """The belief before any input, (G,)."""
        return self._prior.copy()

    def update(self, belief: FloatArray, u: FloatArray, state: FloatArray, action_of: ActionOf) -> FloatArray:
        """The belief after one input (equation 9).

        Args:
            belief: (G,), the belief so far.
            u: (d,), the input.
            state: (n,), rad.
            action_of: what inputs (K, d) would command in this state, (K, n), rad/s.

        Returns:
            (G,), sums to one; ``belief`` itself where the input is zero or not finite.
        """
        if not 0.0 < u @ u < np.inf:
            return belief
        return self.observe(belief, state, action_of(self._alternatives(u)))

    def observe(self, belief: FloatArray, state: FloatArray, actions: FloatArray) -> FloatArray:
        """The belief after the person chose ``actions[0]`` where they could have chosen any of them.

        Args:
            belief: (G,), the belief so far.
            state: (n,), rad.
            actions: (K, n), rad/s.

        Returns:
            (G,), sums to one; ``belief`` itself where an action is not finite.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            away = self.goals - (state + self.horizon_s * actions)[:, None]
            distance = (away * away).sum(axis=-1)
        if not np.isfinite(distance).all():
            return belief
        return self._posterior(belief, distance)

    def _posterior(self, belief: FloatArray, distance: FloatArray) -> FloatArray:
        """Bayes' rule in log space, from distances D (K, G) of which the first row was chosen."""
        # Relative to the chosen row: log P = -log Σ exp(beta (D_chosen - D)), shifted by its largest term.
        gained = self.beta * (distance[0] - distance)
        largest = gained.max(axis=0)
        log_likelihood = -largest - np.log(np.exp(gained - largest).sum(axis=0))
        # A goal without any probability would give log(0); with this stand-in it keeps none.
        score = np.log(np.maximum(belief, 1e-300)) + self.period_s / self.horizon_s * log_likelihood
        weight = np.exp(score - score.max())
        return self._kept_above_floor(weight / weight.sum())

    def _kept_above_floor(self, belief: FloatArray) -> FloatArray:
        """The belief with every goal at ``floor`` or above; unchanged where that is so already."""
        above = np.maximum(belief - self.floor, 0.0)
        return self.floor + (1.0 - self.floor * len(belief)) / above.sum() * above

    def _alternatives(self, u: FloatArray) -> FloatArray:
        """``U`` of the likelihood, (K, d), with ``u`` itself first."""
        if len(u) == 1:
            return np.stack([u, -u])
        if len(u) == 2:
            return self._turns @ u
        along = np.linalg.norm(u) * np.eye(len(u))
        return np.concatenate([u[None], along, -along])

    @cached_property
    def _turns(self) -> FloatArray:
        """(8, 2, 2), rotations by equal angles, no turn first."""
        angle = np.arange(_ALTERNATIVES) * (2 * np.pi / _ALTERNATIVES)
        cos, sin = np.cos(angle), np.sin(angle)
        return np.stack([np.stack([cos, -sin], -1), np.stack([sin, cos], -1)], -2)

    def _checked_prior(self, prior: FloatArray | None) -> FloatArray:
        count = len(self.goals)
        if prior is None:
            return np.full(count, 1 / count)
        given = np.asarray(prior, dtype=float)
        if given.shape != (count,) or not (given > 0).all() or not np.isfinite(given).all():
            raise UserError(f"The belief's prior must be {count} positive finite weights, one per goal.")
        return self._kept_above_floor(given / given.sum())
