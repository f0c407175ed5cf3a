"""Gaps within episodes, and episodes of different rates."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final, Literal

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, IntArray
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.plausibility import RATE_TOLERANCE

Gaps = Literal["refuse", "split", "keep"]
"""Refuse an episode with a gap, make an episode of each part, or keep it whole."""

GAP_S: Final = 0.5
GAP_STEPS: Final = 5.0  # a gap is longer than `GAP_S` and than so many median steps of its episode
_ROUNDING: Final = 1e-6  # of a sample: a span of whole samples must not lose one


def typical_rate_hz(episodes: Sequence[Episode]) -> float:
    """Samples per second outside gaps, rounded to a whole number within 1 %; 0 where no time passes."""
    steps = np.concatenate([np.zeros(0), *(np.diff(one.timestamp) for one in episodes)])
    steps = steps[~_is_gap(steps)]
    elapsed_s = float(steps.sum())
    rate = len(steps) / elapsed_s if elapsed_s > 0 else 0.0
    whole = np.floor(rate + 0.5)
    return float(whole) if abs(rate - whole) < 0.01 * rate else rate


def split_at_gaps(data: SourceData, gaps: Gaps, source: str) -> SourceData:
    """Refuse, split or keep episodes with gaps; unchanged data without any, else with a note.

    Parts of one sample are omitted. Validation later refuses episodes whose times do not grow.
    """
    found: list[str] = []
    parts: list[tuple[str, Episode]] = []
    for name, episode in zip(data.episode_names, data.demonstrations.episodes, strict=True):
        cuts = _gaps(episode)
        if not len(cuts):
            parts.append((name, episode))
            continue
        steps = np.diff(episode.timestamp)
        worst = cuts[np.argmax(steps[cuts])]
        found.append(
            f"episode {name} has {len(cuts)} {'gap' if len(cuts) == 1 else 'gaps'}, the longest of"
            f" {steps[worst]:.4g} s after {episode.timestamp[worst]:.4g} s"
        )
        ends = [0, *(cuts + 1), len(episode.state)]
        parts += [
            (f"{name}.{number}", _from_zero(episode.at(slice(first, stop))))
            for number, (first, stop) in enumerate(pairwise(ends))
            if stop - first > 1
        ]
    if not found:
        return data
    if gaps == "refuse":
        raise UserError(
            f"{source}: {'; '.join(found[:3])}: pass --gaps split to make an episode of each part,"
            " --leave-out and the episodes' names, or --gaps keep to take motion across a gap for even."
        )
    if gaps == "keep":
        return replace(data, record={**data.record, "warning": f"kept as they are: {'; '.join(found)}"})
    names, episodes = zip(*parts, strict=True) if parts else ((), ())
    return replace(
        data,
        demonstrations=replace(data.demonstrations, episodes=episodes),
        names=names,
        record={**data.record, "gaps": f"split into {len(parts)} episodes: {'; '.join(found)}"},
    )


def check_one_rate(demonstrations: Demonstrations, names: Sequence[str], source: str) -> None:
    """Refuse episodes of different rates."""
    # Of an even number of steps the lower of the two in the middle: a pause in a short episode is no rate.
    steps = [np.percentile(np.diff(one.timestamp), 50, method="lower") for one in demonstrations.episodes]
    rates = [1.0 / float(step) for step in steps]
    slow, fast = int(np.argmin(rates)), int(np.argmax(rates))
    if rates[fast] > (1.0 + RATE_TOLERANCE) * rates[slow]:
        raise UserError(
            f"{source}: episode {names[slow]} is sampled at {rates[slow]:.4g} Hz and episode {names[fast]} at"
            f" {rates[fast]:.4g} Hz: bring all to one rate with `latentarm import --resample-hz"
            f" {rates[slow]:.4g}`, or import some with --leave-out."
        )


def resampled(
    demonstrations: Demonstrations, rate_hz: float, names: Sequence[str], source: str
) -> Demonstrations:
    """Every episode at one rate: joints by linear interpolation, all else with its latest values."""
    if not 0 < rate_hz < np.inf:
        raise UserError(f"--resample-hz is {rate_hz:g}: it must be a finite number above zero.")
    episodes: list[Episode] = []
    for name, episode in zip(names, demonstrations.episodes, strict=True):
        count = int(episode.timestamp[-1] * rate_hz + _ROUNDING) + 1
        if len(_gaps(episode)) or count < 2:
            why = "has a gap: pass --gaps split" if count > 1 else f"is shorter than a step at {rate_hz:g} Hz"
            raise UserError(f"{source}: episode {name} {why}, or leave it out with --leave-out {name}.")
        time_s = np.arange(count) / rate_hz
        last = np.searchsorted(episode.timestamp, time_s + _ROUNDING / rate_hz, side="right") - 1
        last[-1] = len(episode.timestamp) - 1  # what is recorded at the very end only, such as success, stays
        state = np.stack([np.interp(time_s, episode.timestamp, joint) for joint in episode.state.T], axis=1)
        episodes.append(replace(episode.at(last), state=state, timestamp=time_s))
    return replace(demonstrations, episodes=tuple(episodes), rate_hz=rate_hz)


def _is_gap(steps: FloatArray) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    return steps > max(GAP_S, GAP_STEPS * float(np.median(steps))) if len(steps) else np.zeros(0, np.bool_)


def _gaps(episode: Episode) -> IntArray:
    """Samples before a gap; none in an episode that is ragged or whose times do not grow."""
    time_s = episode.timestamp
    action = () if episode.action is None else (episode.action,)
    recorded = (episode.state, *action, *episode.extras.values())
    if time_s.ndim != 1 or any(values.shape[:1] != time_s.shape for values in recorded):
        return np.zeros(0, np.int64)
    steps = np.diff(time_s)
    return np.flatnonzero(_is_gap(steps) & bool((steps > 0).all()))


def _from_zero(episode: Episode) -> Episode:
    return replace(episode, timestamp=episode.timestamp - episode.timestamp[0])
