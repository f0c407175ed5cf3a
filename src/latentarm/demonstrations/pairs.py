"""Context-action pairs ``(c, a)`` from demonstrations, for training decoders."""

from typing import Literal

import numpy as np

from latentarm.core.context import Named
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, Demonstrations, Episode, FloatArray, IntArray, Pairs
from latentarm.demonstrations.contexts import context_layout, episode_contexts
from latentarm.demonstrations.held import held_things, moved_to
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.stillness import moving_range


def make_pairs(
    demonstrations: Demonstrations,
    window: int,
    state_noise_rad: float,
    context: Named,
    rng: np.random.Generator,
    actions: Literal["displacement", "recorded"] = "displacement",
    chain: Chain | None = None,
) -> Pairs:
    """Draw every context-action pair from validated demonstrations.

    Without recorded actions, the action of sample t is the displacement to the state k samples later, over
    the time between the two: ``a = (q[t+k] - q[t]) / |time[t+k] - time[t]|`` for k in ±1..±``window`` within
    the episode. Negative k runs the demonstration backwards: a stick should command both directions of a
    motion. Using the timestamps keeps an uneven rate from distorting speeds.

    Noise of SD ``state_noise_rad`` is added to a copy of the states after all actions have come from the
    clean ones. Otherwise the action would contain the noise, and a model would score by removing it.

    Still samples before the first motion and after the last are omitted: a person who waits with a hand on
    the arm demonstrates nothing. Pauses within a motion stay. Without ``chain`` the arm holds nothing.
    """
    if window < 1:
        raise UserError(f"The pair window is {window} samples; it must be at least 1.")
    if not (np.isfinite(state_noise_rad) and state_noise_rad >= 0):
        raise UserError(
            f"The state noise is {state_noise_rad:g} rad; it must be a finite number, zero or more."
        )
    contexts: list[FloatArray] = []
    taken: list[FloatArray] = []
    owner: list[IntArray] = []
    held: list[BoolArray] = []
    layout = context_layout(demonstrations, context)
    for index, episode in enumerate(demonstrations.episodes):
        moving = slice(*moving_range(episode.state, episode.timestamp))
        recorded = actions == "recorded"
        start, action = _recorded(episode, moving, index) if recorded else _displaced(episode, moving, window)
        seen = episode_contexts(episode, context, index)
        contexts.append(seen[start])
        held.append(held_things(chain, layout, seen)[start])
        taken.append(action)
        owner.append(np.full(len(start), index, dtype=np.int64))
    clean = np.concatenate(contexts)
    if not len(clean):
        raise UserError("The arm never moves in these demonstrations, so there is nothing to learn from.")
    holding = np.concatenate(held)
    there = clean[:, : demonstrations.dof]
    there = there + rng.normal(scale=state_noise_rad, size=there.shape)
    return Pairs(
        context=moved_to(chain, layout, clean, holding, there),
        clean_context=clean,
        action=np.concatenate(taken),
        episode=np.concatenate(owner),
        held=holding,
    )


def _displaced(episode: Episode, moving: slice, window: int) -> tuple[IntArray, FloatArray]:
    """Sample indices (P,) and the actions (P, n) that start there, ordered by sample, then by k."""
    samples = np.arange(moving.start, moving.stop)
    # A window beyond the motion adds no pair, and must not cost memory either.
    window = min(window, max(len(samples) - 1, 1))
    shift = np.concatenate([np.arange(-window, 0), np.arange(1, window + 1)])
    start = np.repeat(samples, len(shift))
    end = (samples[:, None] + shift).ravel()
    inside = (end >= moving.start) & (end < moving.stop)
    start, end = start[inside], end[inside]
    elapsed = np.abs(episode.timestamp[end] - episode.timestamp[start])
    return start, (episode.state[end] - episode.state[start]) / elapsed[:, None]


def _recorded(episode: Episode, moving: slice, index: int) -> tuple[IntArray, FloatArray]:
    """Sample indices (P,) and the actions (P, n) recorded there."""
    if episode.action is None:
        raise UserError(
            f"Episode {index} has no recorded actions; take them from the states instead (displacement)."
        )
    return np.arange(moving.start, moving.stop), episode.action[moving]
