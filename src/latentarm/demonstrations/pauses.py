"""Converts drives at a control loop's rate into demonstrations."""

from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Provenance
from latentarm.demonstrations.gripper import OBSERVED
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.kinematics.stillness import STILL_RAD_S

_ROUNDING: Final = 1e-6  # of a sample: a span of whole samples must not get one more


def without_pauses(demonstrations: Demonstrations, rate_hz: float) -> Demonstrations:
    """The same motions at another rate, without the pauses in them.

    A person who steers two axes at a time stops to switch and to think. An action is a displacement over
    time, so pauses would teach the model to crawl there. Time stands still here while no joint exceeds
    `STILL_RAD_S`; states are linear interpolations at even steps of the rest, plus the last state. A control
    loop's rate is too high for learning: within the 5 samples of an action's window, an arm at 100 Hz hardly
    moves.

    Actions and further features are omitted, because their moments are gone. Features of a gripper and poses
    of things stay, as they were when the arm went on. Episodes without motion are left out.
    """
    episodes = [_moving(episode, rate_hz) for episode in demonstrations.episodes]
    kept = tuple(episode for episode in episodes if episode is not None)
    if not kept:
        raise UserError("The arm never moves in these episodes, so there is nothing to learn from.")
    return replace(demonstrations, episodes=kept, rate_hz=rate_hz)


def _moving(episode: Episode, rate_hz: float) -> Episode | None:
    moved_s = _moving_time(episode.state, episode.timestamp)
    samples = int(np.ceil(moved_s[-1] * rate_hz - _ROUNDING))
    if samples == 0:
        return None
    timestamp = np.arange(samples + 1) / rate_hz
    # Where the clock stands still, one sample is as good as another.
    moments, first = np.unique(moved_s, return_index=True)
    states = episode.state[first]
    # Beyond the end interpolation stays at the last state, which is not the first one of its moment.
    states[-1] = episode.state[-1]
    state = np.stack([np.interp(timestamp, moments, joint) for joint in states.T], axis=1)
    # Where the clock stands still, a gripper or a thing may move: the arm goes on with what has become of it.
    last = np.searchsorted(moved_s, timestamp + _ROUNDING / rate_hz, side="right") - 1
    extras = {name: episode.extras[name][last] for name in (*OBSERVED, ENVIRONMENT) if name in episode.extras}
    # Where it was recorded matters to learning, and not who recorded it.
    whole = episode.provenance
    kept = None if whole is None else Provenance(task_name=whole.task_name, shadow=whole.shadow)
    return Episode(state=state, timestamp=timestamp, task=episode.task, extras=extras, provenance=kept)


def _moving_time(state: FloatArray, timestamp: FloatArray) -> FloatArray:
    """(T,), time in motion up to each sample, s."""
    step_s = np.diff(timestamp)
    moves = np.abs(np.diff(state, axis=0)).max(axis=1) > STILL_RAD_S * step_s
    return np.concatenate([[0.0], np.cumsum(np.where(moves, step_s, 0.0))])
