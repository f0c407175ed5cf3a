"""The belief along demonstrations, so that models can be trained on ``c = (s, b)``."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from latentarm.assistance.belief import BoltzmannBelief
from latentarm.errors import UserError
from latentarm.types import Demonstrations, Episode, FloatArray

_STANDSTILL = 0.02
"""Joint speed ‖a‖, rad/s, below which a demonstration stands still and says nothing."""


def annotate(
    demonstrations: Demonstrations,
    beta: float = 20.0,
    horizon_s: float = 0.5,
    floor: float = 0.01,
) -> Demonstrations:
    """Add the belief over the demonstrations' own goals to every episode as ``extras["belief"]``.

    The update is equation 9 as `BoltzmannBelief` has it when a person drives, with the same
    parameters; only the choice ``U`` differs, because a demonstration has no inputs: beside the
    demonstrated action it holds moves at the same speed straight towards each goal, which stop at
    the goal. The belief at a sample rests on the samples before it.

    Args:
        demonstrations: with at least one goal; no episode is changed in place.
        beta: rationality, 1/rad².
        horizon_s: look-ahead, s.
        floor: smallest probability of any goal.

    Returns:
        The same demonstrations with beliefs (T, G).

    Raises:
        UserError: the demonstrations name no goals, or a parameter is out of its range.
    """
    if not demonstrations.goals:
        raise UserError("The demonstrations name no goals, so there is no belief to compute along them.")
    goals = np.stack([goal.configuration for goal in demonstrations.goals])
    belief = BoltzmannBelief(goals, beta, horizon_s, period_s=1 / demonstrations.rate_hz, floor=floor)
    return replace(
        demonstrations, episodes=tuple(_annotated(episode, belief) for episode in demonstrations.episodes)
    )


def _annotated(episode: Episode, belief: BoltzmannBelief) -> Episode:
    beliefs = [belief.initial()]
    velocity = np.diff(episode.state, axis=0) / np.diff(episode.timestamp)[:, None]
    for state, action in zip(episode.state, velocity, strict=False):
        seen = beliefs[-1]
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
