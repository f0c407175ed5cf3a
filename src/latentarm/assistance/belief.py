"""Belief over goals (equation 9): the base class of all rules, and the inputs that form a choice."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from copy import copy
from typing import Final, Protocol, Self, TypedDict, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray

ActionOf = Callable[[FloatArray], FloatArray]
"""Inputs (..., K, d) to the actions ``a_h`` (..., K, n), rad/s, that they would cause in these states."""

BELIEF_PERIOD_S: Final = 0.1  # how often the belief is updated, s, on the page and in simulated drives
_LEAST = 1e-300  # stands in for a probability of zero, which has no logarithm


class Rule(Protocol):
    """Makes a belief over given goals; every class of beliefs does."""

    def __call__(self, goals: FloatArray, *, period_s: float) -> "Belief":
        """A belief over goals (G, n), rad, that is updated every ``period_s``."""
        ...


class BeliefOptions(TypedDict, total=False):
    """Parameters of every belief besides its rule's own; see `Belief`."""

    period_s: float
    prior: FloatArray | None
    floor: float
    most: float
    memory_s: float


class Belief(ABC):
    """Bayes' rule over goals, ``b'(g) ∝ P(u | s, g) b(g)`` (equation 9); the likelihood is the rule's own.

    A person decides once per look-ahead ``tau``: an update every ``period_s`` counts as the share
    ``period_s / tau`` of a decision, so the belief does not depend on the rate of the loop.
    Probabilities are kept at ``floor`` or above, so that a person can always change their mind.

    Beliefs, inputs, states and actions may have leading axes, which broadcast: many drives are updated
    in one call. A belief is stateless: probabilities are passed in and returned.

    Args:
        goals: (G, n), the goals' configurations, rad.
        horizon_s: the look-ahead tau, s; the period where None.
        period_s: time between updates, s.
        prior: (G,), the belief before any input; uniform where None.
        floor: smallest probability of any goal, in [0, 1/G).
        most: largest probability of any goal, in (1/G, 1]; what is over is shared evenly among the others.
            A single goal keeps its whole belief.
        memory_s: evidence fades by e in this time of updates, s: with each, ``log b(g)`` returns towards the
            prior by the share ``1 - exp(-period_s / memory_s)``. Bayes' rule alone is an integrator, whose
            confidence grows with every consistent input and takes as many to undo (Aronson and Short 2024);
            infinite here is Bayes' rule alone.

    Raises:
        UserError: a parameter is not finite or out of its range.
    """

    def __init__(
        self,
        goals: FloatArray | Sequence[FloatArray],
        horizon_s: float | None = None,
        period_s: float = 0.05,
        prior: FloatArray | None = None,
        floor: float = 0.01,
        most: float = 1.0,
        memory_s: float = math.inf,
    ) -> None:
        self.goals = np.ascontiguousarray(goals, dtype=float)
        if self.goals.ndim != 2 or not self.goals.size or not np.isfinite(self.goals).all():
            raise UserError("A belief needs at least one goal, each a finite configuration in rad.")
        self.period_s = positive("period_s", period_s)
        self.horizon_s = period_s if horizon_s is None else positive("horizon_s", horizon_s)
        # A floor within rounding of 1/G would leave no probability to distribute.
        if not 0 <= floor < (1 - 1e-9) / len(self.goals):
            raise UserError(f"The belief's floor must be in [0, 1/{len(self.goals)}), not {floor}.")
        if not (1 / len(self.goals) < most <= 1 or (len(self.goals) == 1 and 0 < most <= 1)):
            raise UserError(f"The belief's most must be in (1/{len(self.goals)}, 1], not {most}.")
        self.floor = floor
        self.most = most
        if not memory_s > 0:
            raise UserError(f"The belief's memory_s must be positive, not {memory_s}.")
        self._kept = math.exp(-period_s / memory_s)
        self._share = period_s / self.horizon_s
        self._above_floors = 1.0 - floor * len(self.goals)
        self._prior = self._checked_prior(prior)
        self._log_prior = np.log(np.maximum(self._prior, _LEAST))

    def over(self, goals: FloatArray) -> Self:
        """The same belief after its goals have moved to ``goals`` (G, n), rad; their number and prior stay.

        Raises:
            ValueError: these are not as many configurations of as many joints, or not finite.
        """
        if goals.shape != self.goals.shape or not np.isfinite(goals).all():
            raise ValueError(f"goals of shape {goals.shape} cannot take the place of {self.goals.shape}")
        moved = copy(self)
        moved.goals = goals
        return moved

    @abstractmethod
    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        """``log P(u | s, g)`` of one decision, (..., G), up to a term that all goals share.

        The state is (..., n), rad; actions are (..., K, n), rad/s: the chosen one first, then its
        alternatives.
        """

    @final
    def initial(self) -> FloatArray:
        """The belief before any input, (G,)."""
        return self._prior.copy()

    @final
    def update(self, belief: FloatArray, u: FloatArray, state: FloatArray, action_of: ActionOf) -> FloatArray:
        """The belief (..., G) after one input ``u`` (..., d) in a state (..., n), rad (equation 9).

        ``action_of`` maps inputs (..., K, d) in these states to actions (..., K, n), rad/s; inputs that are
        not finite reach it as zero. The belief stays where the input is zero or not finite, or an action is
        not finite.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            size = np.vecdot(u, u)
            given = (size > 0.0) & (size < np.inf)
            # Counting is the quickest way to ask whether all of a few are true.
            count = np.count_nonzero(given)
            if not count and belief.ndim >= max(u.ndim, state.ndim):
                return belief
            everywhere = count == given.size
            actions = action_of(alternatives(u if everywhere else np.where(given[..., None], u, 0.0)))
            if u.shape[-1] == 1:
                actions = at_one_speed(actions)
            after = self._posterior(belief, state, actions)
            return after if everywhere else np.where(given[..., None], after, belief)

    @final
    def observe(self, belief: FloatArray, state: FloatArray, actions: FloatArray) -> FloatArray:
        """The belief (..., G) after the choice of ``actions[..., 0, :]`` among actions (..., K, n), rad/s.

        It stays where an action is not finite.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            return self._posterior(belief, state, actions)

    def _posterior(self, belief: FloatArray, state: FloatArray, actions: FloatArray) -> FloatArray:
        """Bayes' rule in log space; an overflow counts as no evidence."""
        # log(0) for a goal without probability; this substitute leaves it without.
        before = np.log(np.maximum(belief, _LEAST))
        if self._kept < 1.0:
            before = self._log_prior + self._kept * (before - self._log_prior)
        score = before + self._share * self.log_likelihood(state, actions)
        weight = np.exp(score - np.maximum.reduce(score, axis=-1, keepdims=True))
        after = self._kept_within(weight / np.add.reduce(weight, axis=-1, keepdims=True))
        sound_actions, sound_score = np.isfinite(actions), np.isfinite(score)
        if np.count_nonzero(sound_actions) == actions.size and np.count_nonzero(sound_score) == score.size:
            return after
        sound = np.all(sound_actions, axis=(-2, -1)) & np.all(sound_score, axis=-1)
        return np.where(sound[..., None], after, belief)

    def _kept_within(self, belief: FloatArray) -> FloatArray:
        """The belief with every goal at ``floor`` or above, and none above ``most``."""
        floored = self._kept_above_floor(belief)
        if self.most == 1.0 or len(self.goals) == 1:
            return floored
        over = np.maximum(np.maximum.reduce(floored, axis=-1, keepdims=True) - self.most, 0.0)
        shared = floored + over / (len(self.goals) - 1)
        return np.where(floored > self.most, self.most, shared)

    def _kept_above_floor(self, belief: FloatArray) -> FloatArray:
        """The belief with every goal at ``floor`` or above; unchanged if it already is."""
        above = np.maximum(belief - self.floor, 0.0)
        return self.floor + self._above_floors / np.add.reduce(above, axis=-1, keepdims=True) * above

    def _checked_prior(self, prior: FloatArray | None) -> FloatArray:
        count = len(self.goals)
        if prior is None:
            return np.full(count, 1 / count)
        given = np.asarray(prior, dtype=float)
        if given.shape != (count,) or not (given > 0).all() or not np.isfinite(given).all():
            raise UserError(f"The belief's prior must be {count} positive finite weights, one per goal.")
        return self._kept_within(given / given.sum())


def log_choice(better: FloatArray) -> FloatArray:
    """``-log Σ_K exp(better)`` (..., G), log probability of a Boltzmann-rational person's choice.

    ``better`` (..., K, G) is the log probability of each alternative relative to the choice, which is among
    them.
    """
    # Shifted by its largest term, so that nothing overflows.
    largest = np.maximum.reduce(better, axis=-2, keepdims=True)
    return -largest[..., 0, :] - np.log(np.add.reduce(np.exp(better - largest), axis=-2))


def positive(name: str, value: float) -> float:
    """The value of a belief's parameter, refused unless it is a positive finite number."""
    if not 0 < value < np.inf:
        raise UserError(f"The belief's {name} must be positive and finite, not {value}.")
    return value


def not_negative(name: str, value: float) -> float:
    """The value of a belief's parameter, refused unless it is a finite number of zero or more."""
    if not 0 <= value < np.inf:
        raise UserError(f"The belief's {name} must be zero or more and finite, not {value}.")
    return value


_ANGLES = np.arange(8) * (2 * np.pi / 8)
_COS, _SIN = np.cos(_ANGLES), np.sin(_ANGLES)
_TURNS = np.stack([np.stack([_COS, -_SIN], -1), np.stack([_SIN, _COS], -1)], -2)
"""(8, 2, 2), rotations by equal angles, no turn first."""

_LEVELS = np.array([[-1.0], [-0.6], [-0.2], [0.2], [0.6], [1.0]])
"""(6, 1), how far a person with one axis may press it."""


def alternatives(u: FloatArray) -> FloatArray:
    """The inputs (..., K, d) that the person could have given, ``u`` (..., d) first.

    - Two axes: ``u`` turned through eight equal angles.
    - One axis: ``u`` and six levels from -1 to 1. A nonlinear decoder need not do the opposite at
      ``-u``, so ``{u, -u}`` would represent the rejected alternatives poorly. Pressing gently is no
      evidence against a goal: such alternatives are compared `at_one_speed`.
    - More axes: ``u`` and ``±‖u‖`` along every axis.
    """
    d = u.shape[-1]
    if d == 2:
        return np.matvec(_TURNS, u[..., None, :])
    if d == 1:
        levels = np.broadcast_to(_LEVELS, (*u.shape[:-1], *_LEVELS.shape))
        return np.concatenate([u[..., None, :], levels], axis=-2)
    along = np.sqrt(np.vecdot(u, u))[..., None, None] * np.eye(d)
    return np.concatenate([u[..., None, :], along, -along], axis=-2)


def at_one_speed(actions: FloatArray) -> FloatArray:
    """Actions (..., K, n) at the speed of the chosen one, the first, so that only directions are compared.

    An action of zero stays zero.
    """
    speed = np.sqrt(np.vecdot(actions, actions))[..., None]
    return actions * (speed[..., :1, :] / np.where(speed > 0.0, speed, 1.0))
