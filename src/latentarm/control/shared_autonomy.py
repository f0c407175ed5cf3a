"""The robot's part of Algorithm 1: belief over goals, assistance, and the bound on that assistance."""

import math
from collections.abc import Sequence
from typing import final

import numpy as np

from latentarm.assistance.belief import Belief
from latentarm.assistance.blending import Arbitration, assistive_action
from latentarm.control.controller import Controller
from latentarm.errors import UserError
from latentarm.types import Context, FloatArray, Goal


@final
class Choices:
    """Lines 6 and 7 of Algorithm 1 for any inputs, asking the controller in as few calls as possible.

    A belief asks about the person's own input together with others, so its action is then already known.

    Args:
        controller: what turns inputs into actions.
        context: of this moment.
        mode: index of the controller's mode.
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
        """Latent action and action of the person's own input.

        Args:
            u: (d,).

        Returns:
            z and a_h, rad/s, of whatever shapes the controller gave.
        """
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
    """What the robot believes and how it helps, over one episode.

    Args:
        dof: n, joints of the arm.
        controller: what turns inputs into actions.
        goals: the discrete goals ``G``.
        belief: how inputs change the belief over goals; None keeps the belief uniform.
        arbitration: how much the robot helps; None never helps.
        dt_s: the loop's period, s.

    Raises:
        UserError: assistance lacks goals, or the belief is over others.
    """

    def __init__(
        self,
        dof: int,
        controller: Controller,
        goals: Sequence[Goal],
        belief: Belief | None,
        arbitration: Arbitration | None,
        dt_s: float,
    ) -> None:
        if (belief is not None or arbitration is not None) and not goals:
            raise UserError("Assistance needs at least one goal: name goals, or leave assistance out.")
        if belief is not None and len(belief.initial()) != len(goals):
            raise UserError(f"The belief is over {len(belief.initial())} goals, but {len(goals)} are given.")
        self._controller = controller
        self._goals = np.array([goal.configuration for goal in goals], dtype=np.float64).reshape(-1, dof)
        self._rule = belief
        self._arbitration = arbitration
        # The belief counts evidence per its own period, whatever the loop's.
        period_s = _BOUND_PERIOD_S if belief is None else belief.period_s
        self._ticks_per_update = max(1, round(period_s / dt_s))
        updates_s = self._ticks_per_update * dt_s
        self._updates_per_bound = max(1, math.ceil(_BOUND_PERIOD_S / updates_s - 1e-9))
        self.acts_at_rest = arbitration is not None and arbitration.acts_at_rest
        self._no_help = np.zeros(dof)
        self._no_help.flags.writeable = False
        self.reset()

    @property
    def belief(self) -> FloatArray:
        """(G,), the belief that the next step will use; empty without goals."""
        return self._belief

    def reset(self) -> None:
        """Begin a new episode."""
        count = len(self._goals)
        if self._rule is not None:
            first = np.array(self._rule.initial())
        else:
            first = np.full(count, 1.0 / count) if count else np.zeros(0)
        first.flags.writeable = False
        self._belief = first
        self._since_update = 0
        self._updates_since_bound = 0
        self._bound_rad: float | None = None

    def rest(self) -> None:
        """Record a step without help: the bound is computed again when help resumes."""
        self._bound_rad = None

    def help(self, u: FloatArray, state: FloatArray) -> tuple[FloatArray, float]:
        """Assistive action (equation 3) and arbitration.

        Args:
            u: (d,), the input.
            state: (n,), rad.

        Returns:
            (n,) rad/s, and alpha in [0, 1].

        Raises:
            ValueError: the arbitration is not in [0, 1].
        """
        if self._arbitration is None:
            return self._no_help, 0.0
        alpha = float(self._arbitration.alpha(u, self._belief))
        if not 0.0 <= alpha <= 1.0:
            raise ValueError(f"an arbitration of {alpha} is not in [0, 1]")
        return assistive_action(state, self._belief, self._goals), alpha

    def update(self, u: FloatArray, context: Context, mode: int, alpha: float) -> tuple[Choices, float]:
        """Line 10 at the belief's own rate, and the bound at most every `_BOUND_PERIOD_S`.

        Args:
            u: (d,), the input.
            context: what this step saw; the bound is that of its belief.
            mode: index of the controller's mode.
            alpha: how much this step helps.

        Returns:
            What is known of inputs at this moment, and the radius of the bound about the likeliest goal
            (equation 14), rad, held in between; NaN without help, or where sigma_h is not known.

        Raises:
            ValueError: the controller or the belief gave something that cannot be.
        """
        self._since_update += 1
        due = self._since_update >= self._ticks_per_update
        self._updates_since_bound += due
        if alpha == 0.0:
            self._bound_rad = None
            bounding = False
        else:
            bounding = self._bound_rad is None or self._updates_since_bound >= self._updates_per_bound
        choices = Choices(self._controller, context, mode)
        if due:
            self._since_update = 0
            self._learn(u, context, choices)
        if bounding:
            self._updates_since_bound %= self._updates_per_bound
            sigma_h = self._controller.speed_bound(context, mode)
            self._bound_rad = math.nan if sigma_h is None else self._bound(sigma_h, context, alpha)
        return choices, math.nan if self._bound_rad is None else self._bound_rad

    def _learn(self, u: FloatArray, context: Context, choices: Choices) -> None:
        if self._rule is None:
            return
        updated = self._rule.update(context.belief, u, context.state, choices)
        if not math.isfinite(sum(updated.tolist())):
            raise ValueError("the belief is not finite")
        updated.flags.writeable = False
        self._belief = updated

    def _bound(self, sigma_h: float, context: Context, alpha: float) -> float:
        """Equation 14's radius about the likeliest goal, rad; NaN where it is not finite.

        `assistance.bound.radius` for one moment, in a quarter of its time.
        """
        belief = context.belief.tolist()
        sure = max(belief)
        away = self._goals - context.state
        distance = np.vecdot(away, away).tolist()
        distance[belief.index(sure)] = 0.0
        delta = (1.0 - alpha) / alpha * sigma_h + (1.0 - sure) * math.sqrt(max(distance))
        return delta / sure if math.isfinite(delta) else math.nan
