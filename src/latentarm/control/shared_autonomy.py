"""The robot's part of Algorithm 1: belief over goals, assistance, and the bound on that assistance."""

import math
from collections.abc import Sequence
from typing import final

import numpy as np

from latentarm.assistance.assistance import Assistance, Contribution
from latentarm.assistance.belief import Belief
from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray, Goal


@final
class Choices:
    """Lines 6 and 7 of Algorithm 1 for any inputs, asking the controller in as few calls as possible.

    A belief asks about the person's own input together with others, so its action is then already known.
    ``mode`` is the index of the controller's mode.
    """

    __slots__ = ("_actions", "_asked", "_context", "_controller", "_latents", "_mode")

    def __init__(self, controller: Controller, context: Context, mode: int) -> None:
        self._controller = controller
        self._context = context
        self._mode = mode
        self._asked: FloatArray | None = None
        self._latents = self._actions = context.state[:0]

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Inputs (K, d) to actions (K, n), rad/s.

        Raises:
            ValueError: the controller gave arrays of other shapes.
        """
        z, actions = self._decoded(inputs)
        if z.shape != inputs.shape or actions.shape != (len(inputs), len(self._context.state)):
            raise ValueError(f"{len(inputs)} inputs gave actions of shape {actions.shape}")
        self._asked, self._latents, self._actions = inputs, z, actions
        return actions

    def chosen(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Z and a_h, rad/s, of the person's own input (d,), of any shapes that the controller gave."""
        if self._asked is not None and self._asked[0].tolist() == u.tolist():
            return self._latents[0], self._actions[0]
        return self._decoded(u)

    def _decoded(self, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
        z = np.asarray(self._controller.latent(inputs, self._context, self._mode), dtype=np.float64)
        return z, np.asarray(self._controller.action(z, self._context, self._mode), dtype=np.float64)


_BOUND_PERIOD_S = 0.05
"""The bound is computed at most this often, s: people read it, the loop does not use it."""


@final
class SharedAutonomy:
    """The robot's belief and help over one episode.

    Without a belief rule the belief stays uniform over the goals ``G``; without assistance nothing helps.

    Raises:
        UserError: assistance lacks goals, or the belief is over others.
    """

    def __init__(
        self,
        dof: int,
        controller: Controller,
        goals: Sequence[Goal],
        belief: Belief | None,
        assistance: Assistance | None,
        dt_s: float,
    ) -> None:
        if (belief is not None or assistance is not None) and not goals:
            raise UserError("Assistance needs at least one goal: name goals, or leave assistance out.")
        if belief is not None and len(belief.initial()) != len(goals):
            raise UserError(f"The belief is over {len(belief.initial())} goals, but {len(goals)} are given.")
        self._controller = controller
        self._count = len(goals)
        self._rule = belief
        self._assistance = assistance
        # The belief counts evidence per its own period, whatever the loop's.
        period_s = _BOUND_PERIOD_S if belief is None else belief.period_s
        self._ticks_per_update = max(1, round(period_s / dt_s))
        updates_s = self._ticks_per_update * dt_s
        self._updates_per_bound = max(1, math.ceil(_BOUND_PERIOD_S / updates_s - 1e-9))
        self.acts_at_rest = assistance is not None and assistance.acts_at_rest
        no_motion = np.zeros(dof)
        no_motion.flags.writeable = False
        self._no_help = Contribution(no_motion, 0.0)
        self.reset()

    @property
    def belief(self) -> FloatArray:
        """(G,), the belief that the next step will use; empty without goals."""
        return self._belief

    def reset(self) -> None:
        """Begin a new episode."""
        count = self._count
        if self._rule is not None:
            first = np.array(self._rule.initial())
        else:
            first = np.full(count, 1.0 / count) if count else np.zeros(0)
        first.flags.writeable = False
        self._belief = first
        self._since_update = 0
        self._updates_since_bound = 0
        self._bound_rad: float | None = None

    def move_goals(self, goals: FloatArray) -> None:
        """Go on with goals (G, n), rad, that have moved; the belief in each stays."""
        if self._rule is not None:
            self._rule = self._rule.over(goals)
        if self._assistance is not None:
            self._assistance = self._assistance.over(goals)

    def rest(self) -> None:
        """Record a step without help: the bound is computed again when help resumes."""
        self._bound_rad = None

    def update(self, u: FloatArray, context: Context, mode: int) -> Choices:
        """Line 10, at the belief's own rate: u (d,) changes the belief for the next step.

        Returns:
            The controller's answers to inputs at this moment.

        Raises:
            ValueError: the controller or the belief gave something impossible.
        """
        self._since_update += 1
        due = self._since_update >= self._ticks_per_update
        self._updates_since_bound += due
        choices = Choices(self._controller, context, mode)
        if due:
            self._since_update = 0
            self._learn(u, context, choices)
        return choices

    def help(self, u: FloatArray, action_human: FloatArray, context: Context) -> Contribution:
        """Line 8: help towards the goals of ``context.belief``, from u (d,) and the person's (n,), rad/s.

        Raises:
            ValueError: the assistance gave shares that are not in [0, 1].
        """
        if self._assistance is None:
            return self._no_help
        return self._assistance.contribution(u, action_human, context.state, context.belief)

    def bound(self, given: Contribution, context: Context, mode: int) -> float:
        """The radius of the bound about the likeliest goal, rad, computed at most every `_BOUND_PERIOD_S`.

        NaN where the person's action is not blended with help, or nothing is known.
        """
        if self._assistance is None or given.alpha == 0.0:
            self._bound_rad = None
            return math.nan
        if self._bound_rad is None or self._updates_since_bound >= self._updates_per_bound:
            self._updates_since_bound %= self._updates_per_bound
            sigma_h = self._controller.speed_bound(context, mode)
            self._bound_rad = (
                math.nan
                if sigma_h is None
                else self._assistance.bound_rad(given, context.state, context.belief, sigma_h)
            )
        return self._bound_rad

    def _learn(self, u: FloatArray, context: Context, choices: Choices) -> None:
        if self._rule is None:
            return
        updated = self._rule.update(context.belief, u, context.state, choices)
        if not math.isfinite(sum(updated.tolist())):
            raise ValueError("the belief is not finite")
        updated.flags.writeable = False
        self._belief = updated
