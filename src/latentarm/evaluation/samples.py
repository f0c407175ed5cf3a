"""The held-out states and start-goal pairs of the measures.

All choices are even spreads over the held-out samples, so that the same data always give the same
states and no seed is needed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.core.context import Named
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, IntArray
from latentarm.demonstrations.contexts import episode_contexts
from latentarm.demonstrations.split import select_episodes
from latentarm.robots.kinematics.stillness import moving_range


@dataclass(frozen=True)
class StartGoalPairs:
    """Start-goal pairs ``(s_i, s_j)`` of held-out states."""

    start: FloatArray  # (P, c), context at the start; its first n entries are the state, rad
    goal: FloatArray  # (P, n), state to be reached, rad


def evenly_spread(count: int, total: int) -> IntArray:
    """``count`` indices (fewer where ``total`` is smaller) spread evenly over ``range(total)``."""
    kept = min(count, total)
    return ((np.arange(kept) + 0.5) * total / max(kept, 1)).astype(np.int64)


def moving_episodes(demonstrations: Demonstrations, held_out: Sequence[int]) -> tuple[Episode, ...]:
    """The held-out episodes without the still samples at their ends, as the training pairs are drawn.

    Raises UserError where none are held out, an index names no episode, or nothing moves in any of them.
    """
    if len(held_out) == 0:
        raise UserError("No episode is held out, so there is nothing to measure on: hold out at least one.")
    moving: list[Episode] = []
    for episode in select_episodes(demonstrations, held_out).episodes:
        first, end = moving_range(episode.state, episode.timestamp)
        if end > first:
            moving.append(episode.at(slice(first, end)))
    if not moving:
        raise UserError("The arm never moves in the held-out episodes, so there is nothing to measure on.")
    return tuple(moving)


def spread_contexts(episodes: Sequence[Episode], context: Named, count: int) -> FloatArray:
    """``count`` contexts (N, c) spread evenly over all samples of the episodes."""
    contexts = np.concatenate([episode_contexts(episode, context) for episode in episodes])
    return contexts[evenly_spread(count, len(contexts))]


def start_goal_pairs(
    episodes: Sequence[Episode], context: Named, *, separation_s: float, count: int
) -> StartGoalPairs:
    """Pairs of states of one episode, the goal ``separation_s`` after the start.

    All samples that have a sample that much later are candidates; ``count`` of them are taken, spread
    evenly. An episode that is shorter gives one pair: its first and its last sample.
    """
    starts: list[FloatArray] = []
    goals: list[FloatArray] = []
    for episode in episodes:
        contexts = episode_contexts(episode, context)
        time = episode.timestamp
        # Timestamps such as 0.1 k are rounded: a goal that is slightly early still counts.
        goal_index = np.searchsorted(time, time + separation_s - 1e-6)
        start_index = np.flatnonzero(goal_index < len(time))
        if len(start_index) == 0:
            start_index, goal_index = np.array([0]), np.array([len(time) - 1])
        starts.append(contexts[start_index])
        goals.append(episode.state[goal_index[start_index]])
    start, goal = np.concatenate(starts), np.concatenate(goals)
    chosen = evenly_spread(count, len(start))
    return StartGoalPairs(start=start[chosen], goal=goal[chosen])
