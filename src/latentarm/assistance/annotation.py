"""The belief along demonstrations, so that models can be trained on ``c = (s, b)``."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from latentarm.assistance.belief import Belief, Rule
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.core.context import BELIEF, Named, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.tasks.step_goals import GoalMove

_STANDSTILL = 0.02  # joint speed ‖a‖, rad/s, below which a demonstration counts as still and is no evidence


def annotate(demonstrations: Demonstrations, rule: Rule = BoltzmannBelief) -> Demonstrations:
    """Add the belief over the demonstrations' own goals to every episode as ``extras["belief"]`` (T, G).

    The rule updates the belief by equation 9, as when a person drives; only the choice ``U`` differs, because
    a demonstration has no inputs: besides the demonstrated action it contains motions at the same speed
    straight towards each goal, which stop at the goal. The belief at a sample depends only on earlier
    samples.

    Raises UserError where the demonstrations name no goals.
    """
    if not demonstrations.goals:
        raise UserError("The demonstrations name no goals, so there is no belief to compute along them.")
    goals = np.stack([goal.configuration for goal in demonstrations.goals])
    belief = rule(goals, period_s=1 / demonstrations.rate_hz)
    return replace(
        demonstrations, episodes=tuple(annotated(episode, belief, {}) for episode in demonstrations.episodes)
    )


def annotated(episode: Episode, belief: Belief, moves: Mapping[int, GoalMove]) -> Episode:
    """One episode of `annotate`, whose goals may move, by the index of the sample from which they have."""
    beliefs = [belief.initial()]
    velocity = np.diff(episode.state, axis=0) / np.diff(episode.timestamp)[:, None]
    for index, (state, action) in enumerate(zip(episode.state, velocity, strict=False)):
        seen = beliefs[-1]
        if (move := moves.get(index)) is not None:
            belief = belief.over(move.goals)
            seen = belief.initial() if move.anew else seen
        speed = float(np.linalg.norm(action))
        if speed > _STANDSTILL:
            straight = _towards(belief.goals, state, speed, belief.horizon_s)
            seen = belief.observe(seen, state, np.concatenate([action[None], straight]))
        beliefs.append(seen)
    extras: Mapping[str, FloatArray] = {**episode.extras, "belief": np.stack(beliefs)}
    return replace(episode, extras=extras)


def _towards(goals: FloatArray, state: FloatArray, speed: float, horizon_s: float) -> FloatArray:
    """Velocities (G, n) straight to each goal, none so fast that it would pass the goal."""
    away = goals - state
    distance = np.sqrt((away * away).sum(axis=-1, keepdims=True))
    return away * np.minimum(speed / np.maximum(distance, 1e-12), 1 / horizon_s)


def prepared(demonstrations: Demonstrations, context: Named) -> Demonstrations:
    """The demonstrations with the belief that the context needs, computed where it is not recorded.

    Raises:
        UserError: a belief is needed, none is recorded, and no goals are known to compute it from.
    """
    if BELIEF not in feature_names(context) or all(
        "belief" in episode.extras for episode in demonstrations.episodes
    ):
        return demonstrations
    return annotate(demonstrations)
